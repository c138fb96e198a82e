"""What the world does to clips, as functions of a canonical motion.

Each keeps what the motion is and who moves: noise on the joints, jitter on their angles (as
markerless capture gives), crops, other speeds. Draws are seeded.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from app.motion.motion import Motion
from app.numerics.arrays import FloatArray, IntArray

Disturb = Callable[[Motion, int], Motion]
"""(motion, seed) -> the disturbed motion."""


def noise(millimeters: float) -> Disturb:
    """White noise of this standard deviation on each coordinate of each joint."""

    def disturb(motion: Motion, seed: int) -> Motion:
        rng = np.random.default_rng(seed)
        drawn = rng.normal(0.0, millimeters / 1000, motion.positions.shape)
        return with_positions(motion, motion.positions + drawn)

    return disturb


def jitter(degrees: float) -> Disturb:
    """A rotation of every joint in every frame, about each axis by this standard deviation."""

    def disturb(motion: Motion, seed: int) -> Motion:
        rng = np.random.default_rng(seed)
        old = motion.positions.astype(np.float64)
        new = old.copy()
        frames, joints, _ = old.shape
        turned = np.tile(np.eye(3), (joints, frames, 1, 1))
        for joint in _from_root(motion.parents):
            drawn = Rotation.from_rotvec(np.radians(degrees) * rng.normal(size=(frames, 3)))
            parent = motion.parents[joint]
            if parent >= 0:
                bone = old[:, joint] - old[:, parent]
                new[:, joint] = new[:, parent] + np.einsum("nij,nj->ni", turned[parent], bone)
                turned[joint] = turned[parent] @ drawn.as_matrix()
            else:
                turned[joint] = drawn.as_matrix()
        return with_positions(motion, new)

    return disturb


def kept(first: float, last: float) -> Disturb:
    """The part of the clip between two shares of its frames, 0..1."""

    def disturb(motion: Motion, _: int) -> Motion:
        start, stop = round(first * motion.frames), round(last * motion.frames)
        return with_positions(motion, motion.positions[start:stop])

    return disturb


def faster(factor: float) -> Disturb:
    """Played this many times as fast; also what a wrong frame rate does."""

    def disturb(motion: Motion, _: int) -> Motion:
        return replace(motion, frame_rate=motion.frame_rate * factor)

    return disturb


def mirrored(motion: Motion, _: int) -> Motion:
    """Left and right exchanged, by the joints' roles. A joint without a role keeps its place."""
    other = np.arange(len(motion.names))
    for role, joint in motion.roles.items():
        other[joint] = motion.roles.get(role.mirrored(), joint)
    return with_positions(motion, motion.positions[:, other] * [-1.0, 1.0, 1.0])


def with_positions(motion: Motion, positions: FloatArray) -> Motion:
    """`motion` with other positions (frames, joints, 3), in meters."""
    return replace(motion, positions=positions.astype(np.float32))


def _from_root(parents: IntArray) -> list[int]:
    """The joints, each after its parent."""
    depths = []
    for joint in range(len(parents)):
        depth, above = 0, parents[joint]
        while above >= 0:
            depth, above = depth + 1, parents[above]
        depths.append(depth)
    order: list[int] = np.argsort(depths, kind="stable").tolist()
    return order
