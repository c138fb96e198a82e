"""From local rotations and translations to a recording's arrays, block by block of frames,
so that temporaries stay small and in the processor's cache."""

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
"""Frames are solved in blocks of about this many joints."""

LocalPose = Callable[[slice], tuple[FloatArray, FloatArray]]
"""Local rotations (n, joints, 4) w x y z and translations (n, joints, 3) of some frames."""


@dataclass(frozen=True, slots=True)
class Solved:
    """Local rotations (frames, joints, 4), translations (frames, joints, 3) or None where
    only roots move, and world positions (frames, joints, 3), all float32."""

    rotations: FloatArray
    translations: FloatArray | None
    positions: FloatArray


def solve(skeleton: Skeleton, frames: int, local_pose: LocalPose, *, moving: bool) -> Solved:
    """Solve `frames` frames; `moving` says whether joints below the roots have translations.

    Raises TooLarge.
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
