"""Puts the feet of a synthesized body on the floor.

The thirteen roles give the positions of the ankles, but not the directions of the feet, and other
tasks of the person have other directions. So the height of the floor follows from the standing
ankles, and the feet are rotated about the ankles. The tip of a foot stays on the floor from the
moment the foot stands until the ankle is too far away. No part of a foot goes below the floor.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from app.motion.frame.foot_contact import LEVEL_PERCENTILE, Stance, stances
from app.motion.posing.posing import ancestors
from app.motion.skeleton.animation import Animation
from app.motion.skeleton.kinematics import forward_kinematics
from app.motion.skeleton.rotations import conjugate, identity_quaternions, multiply
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray

TIP_TOLERANCE = 0.03
"""Meters. The tip leaves the floor if the distance of ankle and tip differs by more than this from
the length of the foot."""

RELEASE = 2.0
"""Standard deviation in frames of the transition between a standing and a free tip."""

MIN_QUANTILE = 0.01
"""Hands, knees and other joints except the feet are below the floor in at most this share of the
frames."""


@dataclass(frozen=True, slots=True)
class Foot:
    """An ankle, the joints below it, and the tip: the one that is farthest from the ankle."""

    ankle: int
    below: list[int]
    tip: int


def feet_of(skeleton: Skeleton, ankles: Sequence[int]) -> list[Foot]:
    """The feet at the ankles; an ankle without joints below it has no foot."""
    still = identity_quaternions((1, len(skeleton)))
    rest = forward_kinematics(skeleton, still, skeleton.offsets[None])[0]
    found = []
    for ankle in ankles:
        below = [joint for joint in range(len(skeleton)) if ankle in ancestors(skeleton, joint)]
        away = np.linalg.norm(rest[below] - rest[ankle], axis=-1)
        if not below or away.max() < 1e-3:
            return []
        found.append(Foot(ankle, below, below[int(np.argmax(away))]))
    return found


def sole_depths(feet: Sequence[Foot], clips: Sequence[FloatArray]) -> FloatArray:
    """(feet,) height in meters of each ankle above the lowest joint of its standing foot.

    It is the median over real clips; each clip is the positions (n, joints, 3).
    """
    deep = [
        [_level(clip[:, foot.ankle, 1]) - _level(_lowest(clip, foot)) for foot in feet]
        for clip in clips
    ]
    return np.asarray(np.maximum(np.median(deep, axis=0), 0.0))


def floor_of(positions: FloatArray, feet: Sequence[Foot], depths: FloatArray) -> float:
    """Y of the floor in meters: below the lowest standing foot, or lower if other joints are."""
    stands = [
        _level(positions[:, foot.ankle, 1]) - deep for foot, deep in zip(feet, depths, strict=True)
    ]
    of_feet = [joint for foot in feet for joint in foot.below]
    others = np.delete(positions[:, :, 1], of_feet, axis=1).min(axis=1)
    return float(min(*stands, np.quantile(others, MIN_QUANTILE)))


def on_the_floor(animation: Animation, feet: Sequence[Foot]) -> Animation:
    """The animation with its feet rotated about the ankles to fit the floor Y = 0."""
    positions = animation.positions()
    ankles = np.stack([positions[:, foot.ankle] for foot in feet], axis=1)
    found = stances(ankles, animation.frame_rate)
    for side, foot in enumerate(feet):
        mine = [stance for stance in found if stance.foot == side]
        tips, sure = _standing_tips(positions, foot, mine)
        bone = positions[:, foot.tip] - positions[:, foot.ankle]
        wanted = tips - positions[:, foot.ankle]
        animation = _turned(animation, foot, _between(bone, wanted, sure))
        animation = _turned(animation, foot, _upwards(animation.positions(), foot))
    return animation


def _level(heights: FloatArray) -> float:
    return float(np.percentile(heights, LEVEL_PERCENTILE))


def _lowest(positions: FloatArray, foot: Foot) -> FloatArray:
    return np.asarray(positions[:, foot.below, 1].min(axis=1))


def _standing_tips(
    positions: FloatArray, foot: Foot, mine: Sequence[Stance]
) -> tuple[FloatArray, FloatArray]:
    """Target positions (n, 3) of a standing tip, and their weights (n,), 0..1."""
    ankle, n = positions[:, foot.ankle], len(positions)
    bones = positions[:, foot.tip] - ankle
    length = float(np.median(np.linalg.norm(bones, axis=-1)))
    tips, sure = np.array(positions[:, foot.tip]), np.zeros(n)
    for stance in mine:
        inside = slice(stance.first, stance.stop)
        ahead = bones[inside].mean(axis=0) * [1.0, 0.0, 1.0]
        base = np.median(ankle[inside], axis=0)
        flat = np.sqrt(max(length**2 - base[1] ** 2, 0.0))
        tip = base * [1.0, 0.0, 1.0] + ahead / max(np.linalg.norm(ahead), 1e-9) * flat
        near = np.exp(-(((np.linalg.norm(tip - ankle, axis=-1) - length) / TIP_TOLERANCE) ** 2))
        near[inside] = 1.0
        # once the tip has left the floor, it stays free
        near[stance.stop :] = np.minimum.accumulate(near[stance.stop :])
        near[: stance.first] = np.minimum.accumulate(near[: stance.first][::-1])[::-1]
        tips = np.where((near > sure)[:, None], tip, tips)
        sure = np.maximum(sure, near)
    return tips, np.asarray(scipy.ndimage.gaussian_filter1d(sure, RELEASE, mode="nearest"))


def _between(start: FloatArray, end: FloatArray, share: FloatArray) -> FloatArray:
    """(n, 4) world rotations by a share (n,) of the angle from start (n, 3) to end (n, 3)."""
    across = np.cross(start, end)
    sine = np.linalg.norm(across, axis=-1)
    angle = np.arctan2(sine, (start * end).sum(axis=-1)) * share
    return _about(across / np.maximum(sine, 1e-9)[:, None], angle)


def _upwards(positions: FloatArray, foot: Foot) -> FloatArray:
    """(n, 4) world rotations that raise the tip until no joint of the foot is below the floor."""
    ankle = positions[:, foot.ankle]
    bone = positions[:, foot.tip] - ankle
    ahead = bone * [1.0, 0.0, 1.0]
    ahead /= np.maximum(np.linalg.norm(ahead, axis=-1, keepdims=True), 1e-9)
    angle = np.zeros(len(positions))
    for joint in foot.below:
        away = positions[:, joint] - ankle
        forth = (away * ahead).sum(axis=-1)
        reach = np.maximum(np.hypot(forth, away[:, 1]), 1e-9)
        least = np.arcsin(np.clip(-ankle[:, 1] / reach, -1.0, 1.0))
        needed = np.where(forth > 0, least - np.arctan2(away[:, 1], forth), 0.0)
        angle = np.maximum(angle, needed)
    return _about(np.cross(ahead, [0.0, 1.0, 0.0]), angle)


def _about(axes: FloatArray, angles: FloatArray) -> FloatArray:
    """(n, 4) rotations about unit axes (n, 3) by angles (n,), radians."""
    return np.concatenate(
        [np.cos(angles / 2)[:, None], axes * np.sin(angles / 2)[:, None]], axis=-1
    )


def _turned(animation: Animation, foot: Foot, turns: FloatArray) -> Animation:
    """The animation with the ankle rotated by the world rotations `turns` (n, 4)."""
    above = identity_quaternions((len(turns),))
    for joint in ancestors(animation.skeleton, foot.ankle):
        above = multiply(animation.rotations[:, joint], above)
    rotations = np.array(animation.rotations)
    local = multiply(multiply(conjugate(above), turns), above)
    rotations[:, foot.ankle] = multiply(local, rotations[:, foot.ankle])
    return replace(animation, rotations=rotations)
