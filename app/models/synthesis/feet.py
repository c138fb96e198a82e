"""Puts the feet of a synthesized body on the floor.

The 13 joint roles give the positions of the ankles, but not the directions of the feet, and the
other tasks of the person have other directions. So the height of the floor is computed from the
standing ankles, and the feet are rotated about the ankles. When a foot stands, its tip is on the
floor. It stays there until the ankle is too far away. No part of a foot is below the floor.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from app.motion.frame.foot_contact import LEVEL_PERCENTILE, Stance, stances
from app.motion.posing.inverse_kinematics import ancestors
from app.motion.skeleton.animation import Animation
from app.motion.skeleton.kinematics import forward_kinematics
from app.motion.skeleton.rotations import conjugate, identity_quaternions, multiply
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray

TIP_TOLERANCE = 0.03
"""Meters. The tip leaves the floor if its distance to the ankle differs from the length of the foot
by more than about this."""

RELEASE = 2.0
"""Standard deviation in frames of the transition between a standing and a free tip."""

MIN_QUANTILE = 0.01
"""The floor may be above other joints than the feet (hands, knees) in this share of the frames."""


@dataclass(frozen=True, slots=True)
class Foot:
    """The joint indices of a foot: the ankle, all joints below it, and the tip.

    The tip is the joint that is farthest from the ankle.
    """

    ankle: int
    below: list[int]
    tip: int


def feet_of(skeleton: Skeleton, ankles: Sequence[int]) -> list[Foot]:
    """The feet at the ankles.

    The list is empty if one of the ankles has no joint below it.
    """
    no_rotation = identity_quaternions((1, len(skeleton)))
    rest = forward_kinematics(skeleton, no_rotation, skeleton.offsets[None])[0]
    feet = []
    for ankle in ankles:
        below = [joint for joint in range(len(skeleton)) if ankle in ancestors(skeleton, joint)]
        distances = np.linalg.norm(rest[below] - rest[ankle], axis=-1)
        if not below or distances.max() < 1e-3:
            return []
        feet.append(Foot(ankle, below, below[int(np.argmax(distances))]))
    return feet


def sole_depths(feet: Sequence[Foot], clips: Sequence[FloatArray]) -> FloatArray:
    """(feet,) height in meters of each ankle above the lowest joint of its standing foot.

    It is the median over real clips; each clip is the positions (n, joints, 3).
    """
    depths = [
        [_level(clip[:, foot.ankle, 1]) - _level(_lowest(clip, foot)) for foot in feet]
        for clip in clips
    ]
    return np.asarray(np.maximum(np.median(depths, axis=0), 0.0))


def floor_of(positions: FloatArray, feet: Sequence[Foot], depths: FloatArray) -> float:
    """Y of the floor in meters: under the lowest standing foot, or lower if other joints are lower.

    positions: (n, joints, 3) meters; depths: (feet,) of `sole_depths`.
    """
    soles = [
        _level(positions[:, foot.ankle, 1]) - depth
        for foot, depth in zip(feet, depths, strict=True)
    ]
    of_feet = [joint for foot in feet for joint in foot.below]
    others = np.delete(positions[:, :, 1], of_feet, axis=1).min(axis=1)
    return float(min(*soles, np.quantile(others, MIN_QUANTILE)))


def on_the_floor(animation: Animation, feet: Sequence[Foot]) -> Animation:
    """The animation with its feet rotated about the ankles to fit the floor Y = 0."""
    positions = animation.positions()
    ankles = np.stack([positions[:, foot.ankle] for foot in feet], axis=1)
    all_stances = stances(ankles, animation.frame_rate)
    for side, foot in enumerate(feet):
        own = [stance for stance in all_stances if stance.foot == side]
        tips, weights = _standing_tips(positions, foot, own)
        bone = positions[:, foot.tip] - positions[:, foot.ankle]
        target = tips - positions[:, foot.ankle]
        animation = _rotated(animation, foot, _toward(bone, target, weights))
        animation = _rotated(animation, foot, _above_floor(animation.positions(), foot))
    return animation


def _level(heights: FloatArray) -> float:
    """The height of a joint while its foot stands: a low percentile of `heights` (n,)."""
    return float(np.percentile(heights, LEVEL_PERCENTILE))


def _lowest(positions: FloatArray, foot: Foot) -> FloatArray:
    """(n,) the height of the lowest joint of the foot in each frame."""
    return np.asarray(positions[:, foot.below, 1].min(axis=1))


def _standing_tips(
    positions: FloatArray, foot: Foot, own: Sequence[Stance]
) -> tuple[FloatArray, FloatArray]:
    """Target positions (n, 3) of a standing tip, and their weights (n,), 0..1."""
    ankle, n = positions[:, foot.ankle], len(positions)
    bones = positions[:, foot.tip] - ankle
    length = float(np.median(np.linalg.norm(bones, axis=-1)))
    tips, weights = np.array(positions[:, foot.tip]), np.zeros(n)
    for stance in own:
        inside = slice(stance.first, stance.stop)
        ahead = bones[inside].mean(axis=0) * [1.0, 0.0, 1.0]
        base = np.median(ankle[inside], axis=0)
        # by Pythagoras: the tip is on the floor, `length` from the ankle
        flat = np.sqrt(max(length**2 - base[1] ** 2, 0.0))
        tip = base * [1.0, 0.0, 1.0] + ahead / max(np.linalg.norm(ahead), 1e-9) * flat
        near = np.exp(-(((np.linalg.norm(tip - ankle, axis=-1) - length) / TIP_TOLERANCE) ** 2))
        near[inside] = 1.0
        # once the tip has left the floor, it stays free
        near[stance.stop :] = np.minimum.accumulate(near[stance.stop :])
        near[: stance.first] = np.minimum.accumulate(near[: stance.first][::-1])[::-1]
        tips = np.where((near > weights)[:, None], tip, tips)
        weights = np.maximum(weights, near)
    return tips, np.asarray(scipy.ndimage.gaussian_filter1d(weights, RELEASE, mode="nearest"))


def _toward(start: FloatArray, end: FloatArray, share: FloatArray) -> FloatArray:
    """(n, 4) world rotations of `start` (n, 3) toward `end` (n, 3) by a share (n,) of the angle."""
    across = np.cross(start, end)
    sine = np.linalg.norm(across, axis=-1)
    angle = np.arctan2(sine, (start * end).sum(axis=-1)) * share
    return _about(across / np.maximum(sine, 1e-9)[:, None], angle)


def _above_floor(positions: FloatArray, foot: Foot) -> FloatArray:
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


def _rotated(animation: Animation, foot: Foot, turns: FloatArray) -> Animation:
    """The animation with the ankle rotated by the world rotations `turns` (n, 4)."""
    above = identity_quaternions((len(turns),))
    for joint in ancestors(animation.skeleton, foot.ankle):
        above = multiply(animation.rotations[:, joint], above)
    rotations = np.array(animation.rotations)
    local = multiply(multiply(conjugate(above), turns), above)
    rotations[:, foot.ankle] = multiply(local, rotations[:, foot.ankle])
    return replace(animation, rotations=rotations)
