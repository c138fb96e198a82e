"""Forward kinematics: from local rotations and translations to world positions.

All joints of one depth are computed at once, for all frames: (frames, joints at this depth, 4). The
tests compare the result with products of 4x4 matrices, joint by joint.
"""

from __future__ import annotations

import numpy as np

from app.deadline import check
from app.motion.skeleton.rotations import multiply, rotate
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray, IntArray


def forward_kinematics(
    skeleton: Skeleton, rotations: FloatArray, translations: FloatArray
) -> FloatArray:
    """(frames, joints, 3) the world positions, float64, in the unit of `translations`.

    rotations: (frames, joints, 4) local unit quaternions w x y z. translations:
    (frames, joints, 3) local (see `local_translations` if only the root moves).
    """
    positions = np.array(translations, dtype=np.float64)
    turned = np.array(rotations, dtype=np.float64)
    for joints in joints_by_depth(skeleton.parents)[1:]:
        check()
        parents = skeleton.parents[joints]
        above = turned[:, parents]
        positions[:, joints] = positions[:, parents] + rotate(above, positions[:, joints])
        turned[:, joints] = multiply(above, turned[:, joints])
    return positions


def local_translations(skeleton: Skeleton, root_positions: FloatArray) -> FloatArray:
    """(frames, joints, 3) the local translations if only the root moves.

    These are the skeleton's offsets, and `root_positions` (frames, 3) for the first root.
    """
    frames = root_positions.shape[0]
    result = np.broadcast_to(skeleton.offsets, (frames, len(skeleton), 3)).astype(np.float64)
    result[:, 0] = root_positions
    return result


def rest_positions(skeleton: Skeleton) -> FloatArray:
    """(joints, 3) the positions if all rotations are 0 and roots are at their offsets."""
    rest = np.array(skeleton.offsets, dtype=np.float64)
    for joints in joints_by_depth(skeleton.parents)[1:]:
        rest[joints] += rest[skeleton.parents[joints]]
    return rest


def joints_by_depth(parents: IntArray) -> list[IntArray]:
    """The joints of each depth, roots first; parents (joints,) come before their children."""
    depth = np.zeros(len(parents), dtype=np.int64)
    for joint, parent in enumerate(parents):
        if parent >= 0:
            depth[joint] = depth[parent] + 1
    return [np.flatnonzero(depth == level) for level in range(int(depth.max(initial=-1)) + 1)]
