"""Computes the arrays of a recording from local rotations and translations.

This is done in blocks of frames, so that temporary arrays are small and fit in the processor's
cache.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from app.formats.common.failures import too_large
from app.motion.skeleton.kinematics import forward_kinematics
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray

MAX_JOINT_FRAMES = 20_000_000
"""Joints times frames: about 800 MB of positions, rotations and translations."""
BLOCK_JOINT_FRAMES = 16_384
"""Joints times frames of one block, about."""

LocalPose = Callable[[slice], tuple[FloatArray, FloatArray]]
"""Gives the local rotations (n, joints, 4) w x y z and translations (n, joints, 3) of n frames."""


@dataclass(frozen=True, slots=True)
class Solved:
    """The arrays of a recording, float32, in the unit and axes of the skeleton.

    rotations: (frames, joints, 4) local, w x y z. translations: (frames, joints, 3) local, None if
    only roots move. positions: (frames, joints, 3) in the world.
    """

    rotations: FloatArray
    translations: FloatArray | None
    positions: FloatArray


def solve(skeleton: Skeleton, frames: int, local_pose: LocalPose, *, moving: bool) -> Solved:
    """The arrays of `frames` frames.

    local_pose: gives the local rotations and translations of a slice of frames. moving: whether
    joints below the roots move relative to their parents. Raises TooLarge for more than
    MAX_JOINT_FRAMES.
    """
    joints = len(skeleton)
    if frames * joints > MAX_JOINT_FRAMES:
        raise too_large("frames", f"expected at most {MAX_JOINT_FRAMES} joints times frames")
    rotations = np.empty((frames, joints, 4), dtype=np.float32)
    translations = np.empty((frames, joints, 3), dtype=np.float32) if moving else None
    positions = np.empty((frames, joints, 3), dtype=np.float32)
    step = max(1, BLOCK_JOINT_FRAMES // joints)
    for block in (slice(start, start + step) for start in range(0, frames, step)):
        turned, moved = local_pose(block)
        rotations[block] = turned
        positions[block] = forward_kinematics(skeleton, turned, moved)
        if translations is not None:
            translations[block] = moved
    return Solved(rotations, translations, positions)
