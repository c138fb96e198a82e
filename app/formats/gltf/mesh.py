"""Makes a mesh of sticks, which shows the skeleton of a GLB file.

Each joint is a small octahedron, and each bone is a long one. The tip of a bone moves with the
joint at its end, so that a stick follows a bone that stretches. The mesh is in the rest pose, in
meters.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.motion.skeleton.kinematics import rest_positions
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray, IntArray

JOINT_RADIUS = 0.012
"""Meters."""
BONE_WIDTH = 0.08
"""Half of the largest width of a bone, as a share of its length."""
WIDEST_SHARE = 0.15
"""The position of the largest width, as a share of the bone's length from its start."""
MIN_BONE_LENGTH = 1e-4
"""Meters. Shorter bones are not drawn."""
_CORNERS = np.array(
    [[0, -1, 0], [1, 0, 0], [0, 0, 1], [-1, 0, 0], [0, 0, -1], [0, 1, 0]], dtype=np.float64
)
_TRIANGLES = np.array(
    [(0, a, b) for a, b in ((1, 2), (2, 3), (3, 4), (4, 1))]
    + [(5, b, a) for a, b in ((1, 2), (2, 3), (3, 4), (4, 1))]
)


@dataclass(frozen=True, slots=True)
class Mesh:
    """Triangles that move with joints.

    corners: (n, 3) meters, in the rest pose. joints: (n,) the joint with which each corner moves.
    triangles: (m, 3) indices of corners, counterclockwise as seen from outside.
    """

    corners: FloatArray
    joints: IntArray
    triangles: IntArray


def stick_mesh(skeleton: Skeleton) -> Mesh:
    """Sticks along the bones and end sites of a skeleton, and an octahedron at each joint.

    skeleton: its offsets are in meters.
    """
    rest = rest_positions(skeleton)
    corners = [rest[joint] + JOINT_RADIUS * _CORNERS for joint in range(len(skeleton))]
    owners = [np.full(6, joint) for joint in range(len(skeleton))]
    bones = [
        (int(parent), joint, rest[joint])
        for joint, parent in enumerate(skeleton.parents)
        if parent >= 0
    ]
    ends = zip(skeleton.end_parents.tolist(), skeleton.end_offsets, strict=True)
    bones += [(joint, joint, rest[joint] + offset) for joint, offset in ends]
    for start, end, tip in bones:
        if np.linalg.norm(tip - rest[start]) > MIN_BONE_LENGTH:
            corners.append(_stick(rest[start], tip))
            # Five corners move with the joint at the start, and the tip with the one at the end.
            owners.append(np.array([start] * 5 + [end]))
    first = 6 * np.arange(len(corners))[:, None, None]
    return Mesh(
        np.concatenate(corners), np.concatenate(owners), (first + _TRIANGLES).reshape(-1, 3)
    )


def _stick(start: FloatArray, tip: FloatArray) -> FloatArray:
    """(6, 3) the corners of an octahedron from `start` (3,) to `tip` (3,), widest near `start`."""
    along = tip - start
    length = np.linalg.norm(along)
    up = along / length
    # The axis that is least parallel to the bone gives the longest cross product.
    side = np.cross(up, np.eye(3)[np.argmin(np.abs(up))])
    side /= np.linalg.norm(side)
    frame = np.stack([side, up, np.cross(side, up)])
    width = BONE_WIDTH * length
    shape = _CORNERS * [width, 0.0, width]
    shape[:, 1] = length * np.array([0.0, *[WIDEST_SHARE] * 4, 1.0])
    return np.asarray(start + shape @ frame)
