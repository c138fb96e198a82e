"""Dances with known stops: the body rests in poses on beats and moves smoothly between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.motion.roles.joint_roles import JointRole
from app.numerics.arrays import FloatArray
from tests.bodies import move_joint, standing, turned_about_y

SWUNG = {
    "left_hand": 0.45, "right_hand": 0.45, "left_elbow": 0.22, "right_elbow": 0.22,
    "left_foot": 0.2, "right_foot": 0.2, "left_knee": 0.1, "right_knee": 0.1, "head": 0.03,
}  # fmt: skip
"""Typical distance of each joint between two poses, meters."""


@dataclass(frozen=True)
class Dance:
    """A dance with known stops and beats.

    positions: (frames, 13, 3) meters; rate: Hz; stops, beats: (k,) and (b,) seconds, all stops on
    beats; tempo: beats per minute.
    """

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
    """A dance that stops on the beats.

    tempo: beats per minute; passed: share of beats on which it does not stop; noise: standard
    deviation of white noise on every coordinate, meters.
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
        move_joint(body, JointRole(role), _eased(t, stops, aims, hold=0.12 * beat))
    sway = _eased(t, stops, rng.normal(size=(len(stops), 3)) * [0.08, 0.02, 0.08], hold=0.0)
    angle = _eased(t, stops, rng.normal(size=(len(stops), 1)) * turning, hold=0.0)[:, 0]
    body = turned_about_y(body, angle) + sway[:, None]
    body = body + rng.normal(size=body.shape) * noise
    return Dance(body, rate, stops, times, tempo)


def _eased(t: FloatArray, knots: FloatArray, values: FloatArray, hold: float) -> FloatArray:
    """(frames, d): the values (k, d) at the knots for `hold` seconds, eased between them."""
    index = np.clip(np.searchsorted(knots, t, side="right") - 1, 0, len(knots) - 2)
    start, stop = knots[index] + hold / 2, knots[index + 1] - hold / 2
    u = np.clip((t - start) / (stop - start), 0, 1)
    ease = (u**3 * (10 - 15 * u + 6 * u * u))[:, None]
    return values[index] + ease * (values[index + 1] - values[index])


def precision_and_recall(
    found: FloatArray, true: FloatArray, within: float = 0.1
) -> tuple[float, float]:
    """Share of `found` times that match a true one, and share of `true` times that are found.

    within: largest difference of a match, seconds. Each time matches at most one other.
    """
    free, hits = list(true), 0
    for time in found:
        near = min(free, key=lambda other: abs(other - time), default=None)
        if near is not None and abs(near - time) <= within:
            free.remove(near)
            hits += 1
    return hits / max(len(found), 1), hits / max(len(true), 1)


def irregular(seed: int, tempo: float, *, stops: int = 20, rate: float = 60.0) -> FloatArray:
    """(frames, 13, 3) m: a dance with stops at random intervals of 0.6 to 1.8 beats."""
    rng = np.random.default_rng(seed)
    beat = 60.0 / tempo
    times = 0.5 + np.cumsum(beat * rng.uniform(0.6, 1.8, stops))
    t = np.arange(int((times[-1] + 0.5 * beat) * rate)) / rate
    body = standing(len(t))
    for role, reach in SWUNG.items():
        aims = rng.normal(size=(stops, 3)) * reach / np.sqrt(2)
        move_joint(body, JointRole(role), _eased(t, times, aims, hold=0.12 * beat))
    return body + rng.normal(size=body.shape) * 0.005
