"""Dances with known stops: poses held on beats, limbs moving smoothly between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.motion.roles.joint_roles import JointRole
from app.numerics.arrays import FloatArray
from tests.bodies import place, standing, turned_about_y

SWUNG = {
    "left_hand": 0.45, "right_hand": 0.45, "left_elbow": 0.22, "right_elbow": 0.22,
    "left_foot": 0.2, "right_foot": 0.2, "left_knee": 0.1, "right_knee": 0.1, "head": 0.03,
}  # fmt: skip
"""Metres that each joint swings from pose to pose."""


@dataclass(frozen=True)
class Dance:
    """positions (frames, 13, 3) metres at `rate`; stops (k,) seconds, all on beats."""

    positions: FloatArray
    rate: float
    stops: FloatArray
    beats: FloatArray
    tempo: float


def dance(
    seed: int,
    tempo: float,
    *,
    beats: int = 16,
    rate: float = 60.0,
    noise: float = 0.005,
    passed: float = 0.15,
    turning: float = 0.3,
) -> Dance:
    """A dance that stops on each beat but the share `passed`, through which it runs on.

    noise: metres (standard deviation) of white noise on every coordinate.
    """
    rng = np.random.default_rng(seed)
    beat = 60.0 / tempo
    first = rng.uniform(0.2, 0.8)
    times = first + beat * np.arange(beats)
    is_stop = rng.random(beats) >= passed
    is_stop[[0, -1]] = True
    stops = times[is_stop]
    t = np.arange(int((times[-1] + 0.5 * beat) * rate)) / rate
    body = standing(len(t))
    for role, reach in SWUNG.items():
        aims = rng.normal(size=(len(stops), 3)) * reach / np.sqrt(2)
        place(body, JointRole(role), _eased(t, stops, aims, hold=0.12 * beat))
    sway = _eased(t, stops, rng.normal(size=(len(stops), 3)) * [0.08, 0.02, 0.08], hold=0.0)
    angle = _eased(t, stops, rng.normal(size=(len(stops), 1)) * turning, hold=0.0)[:, 0]
    body = turned_about_y(body, angle) + sway[:, None]
    body = body + rng.normal(size=body.shape) * noise
    return Dance(body, rate, stops, times, tempo)


def _eased(t: FloatArray, knots: FloatArray, values: FloatArray, hold: float) -> FloatArray:
    """(frames, d): values (k, d) at knots, at rest for `hold` s around each, eased between."""
    index = np.clip(np.searchsorted(knots, t, side="right") - 1, 0, len(knots) - 2)
    start, stop = knots[index] + hold / 2, knots[index + 1] - hold / 2
    u = np.clip((t - start) / (stop - start), 0, 1)
    ease = (u**3 * (10 - 15 * u + 6 * u * u))[:, None]
    return values[index] + ease * (values[index + 1] - values[index])


def precision_and_recall(
    found: FloatArray, true: FloatArray, within: float = 0.1
) -> tuple[float, float]:
    """Share of `found` times that meet a true one, and of `true` ones found, one to one."""
    free, hits = list(true), 0
    for time in found:
        near = min(free, key=lambda other: abs(other - time), default=None)
        if near is not None and abs(near - time) <= within:
            free.remove(near)
            hits += 1
    return hits / max(len(found), 1), hits / max(len(true), 1)


def irregular(seed: int, tempo: float, *, stops: int = 20, rate: float = 60.0) -> FloatArray:
    """(frames, 13, 3): stops as in a dance, but at intervals of .6 to 1.8 beats at random."""
    rng = np.random.default_rng(seed)
    beat = 60.0 / tempo
    times = 0.5 + np.cumsum(beat * rng.uniform(0.6, 1.8, stops))
    t = np.arange(int((times[-1] + 0.5 * beat) * rate)) / rate
    body = standing(len(t))
    for role, reach in SWUNG.items():
        aims = rng.normal(size=(stops, 3)) * reach / np.sqrt(2)
        place(body, JointRole(role), _eased(t, times, aims, hold=0.12 * beat))
    return body + rng.normal(size=body.shape) * 0.005
