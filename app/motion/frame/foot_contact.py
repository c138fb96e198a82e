"""When feet stand on the floor, and how much they slide while they stand."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import BoolArray, FloatArray

MAX_STANDING_HEIGHT = 0.03
"""Meters. A foot at most this far above its standing height is on the floor."""

LEVEL_PERCENTILE = 5.0
"""The percentile of a foot's heights that is its standing height."""

STANDING_SPEED = 0.5
"""Meters per second. A foot that is clearly faster swings, even if it is low."""

BLEND_SECONDS = 0.15
"""Seconds before and after a stance in which the correction of the foot grows from 0 and returns
to 0."""

MIN_STANCE = 0.1
"""Seconds: the shortest time for which a foot stands."""

MIN_CERTAINTY = 0.4
"""The smallest certainty, of 0..1, with which a foot counts as standing."""

FEET = (SUN_ROLES.index(JointRole.LEFT_FOOT), SUN_ROLES.index(JointRole.RIGHT_FOOT))


def is_low(feet: FloatArray) -> BoolArray:
    """(n, 2) whether `feet` (n, 2, 3), in meters, Y up, are as low as when they stand."""
    heights = feet[:, :, 1]
    level = np.percentile(heights, LEVEL_PERCENTILE, axis=0)
    return np.asarray(heights <= level + MAX_STANDING_HEIGHT)


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
    """(n, 2) the certainty, 0..1, that `feet` (n, 2, 3) stand, because they are low and slow.

    feet: left and right, in meters, Y up. rate: frames per second.
    """
    heights = feet[:, :, 1] - np.percentile(feet[:, :, 1], LEVEL_PERCENTILE, axis=0)
    speeds = np.linalg.norm(np.gradient(feet[:, :, [0, 2]], axis=0), axis=-1) * rate
    sure = np.exp(
        -((np.maximum(heights, 0.0) / MAX_STANDING_HEIGHT) ** 2) - (speeds / STANDING_SPEED) ** 2
    )
    return np.asarray(scipy.ndimage.gaussian_filter1d(sure, 1.0, axis=0, mode="nearest"))


def carried_by_feet(origin: FloatArray, feet: FloatArray, rate: float) -> FloatArray:
    """(n, 3) the path of the hips, changed so that standing feet do not slide.

    origin: (n, 3) and feet: (n, 2, 3), in meters, Y up. rate: frames per second. While a foot
    stands, its sliding speed is subtracted from the speed of the hips. In flight the speed of the
    hips does not change. Heights do not change.
    """
    if len(origin) < 2:
        return origin
    # slide (n, 2, 2): meters per frame of each foot along X and Z, weighted by the certainty
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
    """The stances of `feet` (n, 2, 3) that last at least MIN_STANCE, the left foot first.

    feet: in meters, Y up. rate: frames per second.
    """
    found = []
    stands = standing(feet, rate) > MIN_CERTAINTY
    for foot in range(2):
        edges = np.flatnonzero(np.diff(stands[:, foot].astype(int), prepend=0, append=0))
        for first, stop in edges.reshape(-1, 2):
            if (stop - first) / rate >= MIN_STANCE:
                found.append(Stance(foot, int(first), int(stop)))
    return found


def planted(feet: FloatArray, rate: float) -> FloatArray:
    """(n, 2, 3) the feet with each standing foot at a fixed point of the floor, without jumps.

    feet: (n, 2, 3) meters, Y up. rate: frames per second. Each foot is moved by a horizontal
    correction. It is interpolated between stances, and returns to 0 if they are far apart.
    """
    result = np.array(feet, dtype=np.float64)
    reach = max(round(BLEND_SECONDS * rate), 1)
    found = stances(feet, rate)
    for foot in range(2):
        mine = [stance for stance in found if stance.foot == foot]
        if not mine:
            continue
        # The knots of the correction: frames, and the offset along X and Z at each of them.
        frames: list[float] = [-1.0 - reach]
        offsets: list[FloatArray] = [np.zeros(2)]
        for stance in mine:
            inside = result[stance.first : stance.stop, foot][:, [0, 2]]
            away = inside.mean(axis=0) - inside
            _add_gap(frames, offsets, stance.first, reach)
            frames += [float(frame) for frame in range(stance.first, stance.stop)]
            offsets += list(away)
        _add_gap(frames, offsets, len(feet) + 2 * reach, reach)
        n = np.arange(len(feet))
        lead = [np.interp(n, frames, [offset[axis] for offset in offsets]) for axis in (0, 1)]
        result[:, foot, [0, 2]] += np.stack(lead, axis=1)
    return result


def _add_gap(frames: list[float], offsets: list[FloatArray], until: float, reach: int) -> None:
    """Add knots with the correction 0 if the next stance is far from the last one."""
    if until - frames[-1] > 2 * reach:
        frames += [frames[-1] + reach, until - reach]
        offsets += [np.zeros(2), np.zeros(2)]
