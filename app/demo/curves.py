"""Curves over time, of which motions consist.

Each function takes times (frames,) in seconds, or phases in cycles, and returns values (frames,).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.interpolate import BPoly, PchipInterpolator
from scipy.ndimage import gaussian_filter1d

from app.numerics.arrays import FloatArray

Key = tuple[float, float]
"""A pair: time in seconds or phase in cycles, and value."""


def ease(progress: FloatArray) -> FloatArray:
    """The minimum-jerk curve from 0 to 1 (Flash & Hogan 1985), at rest at both ends.

    progress: (frames,); values outside 0..1 are clamped.
    """
    u = np.clip(progress, 0.0, 1.0)
    return np.asarray(u**3 * (10.0 + u * (6.0 * u - 15.0)))


def keyed_curve(times: FloatArray, keys: Sequence[Key], soften: float = 0.0) -> FloatArray:
    """A monotone cubic curve through `keys`, constant before the first and after the last one.

    soften: the standard deviation, in seconds, of a Gaussian that smooths the corners.
    """
    at, values = zip(*keys, strict=True)
    if len(keys) == 1:
        return np.full(len(times), values[0])
    curve = PchipInterpolator(at, values)(np.clip(times, at[0], at[-1]))
    return softened(np.asarray(curve), times, soften)


def softened(curve: FloatArray, times: FloatArray, seconds: float) -> FloatArray:
    """`curve` (frames, ...) smoothed over time by a Gaussian of `seconds`; 0 does not change it."""
    if seconds <= 0.0 or len(times) < 2:
        return curve
    frames = seconds / float(times[1] - times[0])
    return np.asarray(gaussian_filter1d(curve, frames, axis=0, mode="nearest"))


def periodic_curve(phase: FloatArray, points: Sequence[Key]) -> FloatArray:
    """A closed monotone cubic curve through `points` (phase in [0, 1), value)."""
    # three periods in a row, so that the middle one continues smoothly at both ends
    at = np.array([point[0] for point in points])
    values = np.array([point[1] for point in points])
    tiled = np.concatenate([at - 1.0, at, at + 1.0])
    return np.asarray(PchipInterpolator(tiled, np.tile(values, 3))(np.mod(phase, 1.0)))


def quintic_curve(
    times: FloatArray, states: Sequence[tuple[float, float, float, float]]
) -> FloatArray:
    """A curve of quintic pieces through `states` (time, position, velocity, acceleration)."""
    at = [state[0] for state in states]
    curve = BPoly.from_derivatives(at, [list(state[1:]) for state in states])
    return np.asarray(curve(np.clip(times, at[0], at[-1])))


def wobble(times: FloatArray, draw: np.random.RandomState, size: float) -> FloatArray:
    """A slow irregular sway: a sum of sines of 0.15 to 0.9 Hz; size: its standard deviation."""
    rates = draw.uniform(0.15, 0.9, 5)
    phases = draw.uniform(0.0, 2.0 * np.pi, 5)
    weights = 1.0 / (0.3 + rates)
    weights *= np.sqrt(2.0) * size / np.linalg.norm(weights)
    return np.asarray(np.sin(2.0 * np.pi * np.outer(times, rates) + phases) @ weights)
