"""When feet stand on the floor, and how much they slide while they stand."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import BoolArray, FloatArray

LOW = 0.03
"""Meters. A foot at most this far above its standing height is on the floor."""

LEVEL_PERCENTILE = 5.0
"""The percentile of a foot's heights that is its standing height."""

SLOW = 0.5
"""Meters per second. A foot that is clearly faster swings, even if it is low."""

REACH = 0.15
"""Seconds in which a foot moves to the place where it stands, and away from it."""

SHORTEST = 0.1
"""Seconds: the shortest time for which a foot stands."""

FEET = (SUN_ROLES.index(JointRole.LEFT_FOOT), SUN_ROLES.index(JointRole.RIGHT_FOOT))


def is_low(feet: FloatArray) -> BoolArray:
    """(n, 2) whether `feet` (n, 2, 3), in meters, Y up, are as low as when they stand."""
    heights = feet[:, :, 1]
    level = np.percentile(heights, LEVEL_PERCENTILE, axis=0)
    return np.asarray(heights <= level + LOW)


def skating(feet: FloatArray, rate: float) -> float:
    """The mean horizontal speed, m/s, of `feet` (n, 2, 3) while they are low; 0 if never.

    rate: frames per second. A foot that rolls from heel to toe moves too: real walks have a few
    tenths of a meter per second.
    """
    if len(feet) < 2:
        return 0.0
    speeds = np.linalg.norm(np.gradient(feet[:, :, [0, 2]], axis=0), axis=-1) * rate
    low = is_low(feet)
    return float(speeds[low].mean()) if low.any() else 0.0


def standing(feet: FloatArray, rate: float) -> FloatArray:
    """(n, 2) how certain it is, 0..1, that `feet` (n, 2, 3) stand: they are low and slow."""
    heights = feet[:, :, 1] - np.percentile(feet[:, :, 1], LEVEL_PERCENTILE, axis=0)
    speeds = np.linalg.norm(np.gradient(feet[:, :, [0, 2]], axis=0), axis=-1) * rate
    sure = np.exp(-((np.maximum(heights, 0.0) / LOW) ** 2) - (speeds / SLOW) ** 2)
    return np.asarray(scipy.ndimage.gaussian_filter1d(sure, 1.0, axis=0, mode="nearest"))


def carried_by_feet(origin: FloatArray, feet: FloatArray, rate: float) -> FloatArray:
    """(n, 3) the path of the hips `origin` (n, 3), changed such that standing feet do not slide.

    feet: (n, 2, 3) meters. While a foot stands, its sliding speed is subtracted from the hips. In
    flight the speed of the hips does not change. Heights do not change.
    """
    if len(origin) < 2:
        return origin
    sure = standing(feet, rate)
    slide = np.gradient(feet[:, :, [0, 2]], axis=0)
    share = sure / np.maximum(sure.sum(axis=1, keepdims=True), 1.0)
    correction = np.cumsum((share[:, :, None] * slide).sum(axis=1), axis=0)
    moved = np.array(origin)
    moved[:, [0, 2]] -= correction - correction[0]
    return moved


@dataclass(frozen=True, slots=True)
class Stance:
    """The frames first .. stop - 1 in which a foot (0 left, 1 right) stands."""

    foot: int
    first: int
    stop: int


def stances(feet: FloatArray, rate: float) -> list[Stance]:
    """The stances of `feet` (n, 2, 3) that last at least SHORTEST."""
    found = []
    stands = standing(feet, rate) > 0.4
    for foot in range(2):
        edges = np.flatnonzero(np.diff(stands[:, foot].astype(int), prepend=0, append=0))
        for first, stop in edges.reshape(-1, 2):
            if (stop - first) / rate >= SHORTEST:
                found.append(Stance(foot, int(first), int(stop)))
    return found


def planted(feet: FloatArray, rate: float) -> FloatArray:
    """(n, 2, 3) `feet` (n, 2, 3) with each standing foot fixed in place, without jumps."""
    result = np.array(feet, dtype=np.float64)
    reach = max(round(REACH * rate), 1)
    found = stances(feet, rate)
    for foot in range(2):
        mine = [stance for stance in found if stance.foot == foot]
        if not mine:
            continue
        frames: list[float] = [-1.0 - reach]
        offsets: list[FloatArray] = [np.zeros(2)]
        for stance in mine:
            inside = result[stance.first : stance.stop, foot][:, [0, 2]]
            away = inside.mean(axis=0) - inside
            _let_go(frames, offsets, stance.first, reach)
            frames += [float(frame) for frame in range(stance.first, stance.stop)]
            offsets += list(away)
        _let_go(frames, offsets, len(feet) + 2 * reach, reach)
        n = np.arange(len(feet))
        lead = [np.interp(n, frames, [offset[axis] for offset in offsets]) for axis in (0, 1)]
        result[:, foot, [0, 2]] += np.stack(lead, axis=1)
    return result


def _let_go(frames: list[float], offsets: list[FloatArray], until: float, reach: int) -> None:
    """End the correction of a stance, and begin that of the next, if they are far apart."""
    if until - frames[-1] > 2 * reach:
        frames += [frames[-1] + reach, until - reach]
        offsets += [np.zeros(2), np.zeros(2)]
