"""Curves of time from which motions are made: keyed, periodic, eased, gently wobbling.

Every function takes times (frames,) in seconds (or phases in cycles) and returns (frames,).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.interpolate import BPoly, PchipInterpolator
from scipy.ndimage import gaussian_filter1d

from app.numerics.arrays import FloatArray

Key = tuple[float, float]
"""(time in seconds or phase in cycles, value)."""


def ease(progress: FloatArray) -> FloatArray:
    """Minimum-jerk course from 0 to 1 (Flash & Hogan 1985), at rest at both ends; clamps."""
    u = np.clip(progress, 0.0, 1.0)
    return np.asarray(u**3 * (10.0 + u * (6.0 * u - 15.0)))


def keyed(times: FloatArray, keys: Sequence[Key], soften: float = 0.0) -> FloatArray:
    """Monotone cubic curve through `keys`, constant outside them.

    `soften` is the standard deviation, in seconds, of a Gaussian that rounds the corners.
    """
    at, values = zip(*keys, strict=True)
    if len(keys) == 1:
        return np.full(len(times), values[0])
    curve = PchipInterpolator(at, values)(np.clip(times, at[0], at[-1]))
    return softened(np.asarray(curve), times, soften)


def softened(curve: FloatArray, times: FloatArray, seconds: float) -> FloatArray:
    """`curve` (frames, ...) smoothed over time by a Gaussian of `seconds`; 0 leaves it."""
    if seconds <= 0.0 or len(times) < 2:
        return curve
    frames = seconds / float(times[1] - times[0])
    return np.asarray(gaussian_filter1d(curve, frames, axis=0, mode="nearest"))


def periodic(phase: FloatArray, points: Sequence[Key]) -> FloatArray:
    """Closed monotone cubic curve through `points` (phase in [0, 1), value)."""
    at = np.array([point[0] for point in points])
    values = np.array([point[1] for point in points])
    tiled = np.concatenate([at - 1.0, at, at + 1.0])
    return np.asarray(PchipInterpolator(tiled, np.tile(values, 3))(np.mod(phase, 1.0)))


def driven(times: FloatArray, states: Sequence[tuple[float, float, float, float]]) -> FloatArray:
    """Quintic pieces through `states` (time, position, velocity, acceleration)."""
    at = [state[0] for state in states]
    curve = BPoly.from_derivatives(at, [list(state[1:]) for state in states])
    return np.asarray(curve(np.clip(times, at[0], at[-1])))


def wobble(times: FloatArray, draw: np.random.RandomState, size: float) -> FloatArray:
    """Slow irregular sway of about `size` (standard deviation), from sines of .15 to 0.9 Hz."""
    rates = draw.uniform(0.15, 0.9, 5)
    phases = draw.uniform(0.0, 2.0 * np.pi, 5)
    weights = 1.0 / (0.3 + rates)
    weights *= np.sqrt(2.0) * size / np.linalg.norm(weights)
    return np.asarray(np.sin(2.0 * np.pi * np.outer(times, rates) + phases) @ weights)
