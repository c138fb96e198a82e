"""A few poses of a clip that represent all of its poses: the coarse index of pose search.

The keyposes are chosen first. Then the pose that is farthest from all chosen poses is chosen,
until none is farther than TOLERANCE (farthest-point traversal, Gonzalez 1985). Each chosen pose
has a radius: the largest distance of the poses that it represents. So a search can skip clips that
cannot contain a near pose.
"""

from __future__ import annotations

import numpy as np

from app.motion.frame.body_pose import body_poses
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray, IntArray

POSE_WIDTH = 36
"""Numbers of a pose: 12 joints in the body frame. The hips are its origin and are left out."""

TOLERANCE = 0.05
"""Body lengths: how far a pose may be from the pose that represents it."""

FRAMES_PER_POSE = 8
"""At most one pose in this many frames is chosen. So fast movement is covered more coarsely."""

CHUNK = 1800
"""Frames that are covered together. The cost grows with frames times chosen poses."""

_MARGIN = 1e-6
"""Added to the radii, for the rounding of float32."""

_JOINTS = [index for index, role in enumerate(SUN_ROLES) if role is not JointRole.HIPS]


def pose_vectors(positions: FloatArray) -> FloatArray:
    """(n, 36) float32 vectors; the Euclidean distance of two is the RMS distance of their joints.

    positions: (n, 13, 3) in SUN_ROLES order, any unit, Y up. Each pose is in its own body frame,
    in body lengths. A pose without size is NaN. All joints have the same weight: on 228 clips,
    larger weights of hands, feet or trunk changed the precision at 5 by less than .02.
    """
    planes = body_poses(positions).T[:, _JOINTS]  # (3, 12, n), contiguous
    planes /= np.sqrt(len(_JOINTS))
    return np.asarray(planes.astype(np.float32).T.reshape(-1, POSE_WIDTH))


def pose_cover(positions: FloatArray, keyposes: IntArray) -> FloatArray:
    """(k, 38) float32: the frame, the radius (body lengths) and the vector of each chosen pose.

    positions: (n, 13, 3) as in `pose_vectors`. keyposes: (m,) frames that are all chosen. Rows
    are in order of time. Every pose of the clip is within the radius of a chosen pose, except
    poses without size, which are left out.
    """
    vectors = pose_vectors(positions)
    sound = np.flatnonzero(np.isfinite(vectors).all(axis=1))
    is_keypose = np.zeros(len(vectors), dtype=bool)
    is_keypose[keyposes] = True
    covers = [
        _cover(vectors, frames, np.flatnonzero(is_keypose[frames]))
        for frames in np.split(sound, range(CHUNK, len(sound), CHUNK))
        if len(frames)
    ]
    return np.concatenate([np.zeros((0, 2 + POSE_WIDTH), np.float32), *covers])


def _cover(vectors: FloatArray, frames: IntArray, keyposes: IntArray) -> FloatArray:
    """(k, 38) the cover of `frames` (m,) of `vectors` (n, 36); keyposes: indices of `frames`."""
    poses = vectors[frames].astype(np.float64)
    squares = np.vecdot(poses, poses)
    apart = np.full(len(poses), np.inf)
    stands_for = np.zeros(len(poses), dtype=np.int64)
    chosen: list[int] = []
    waiting = keyposes.tolist() or [len(poses) // 2]
    while waiting:
        pose = waiting.pop()
        nearer = squares - 2.0 * (poses @ poses[pose]) + squares[pose]
        stands_for[nearer < apart] = len(chosen)
        np.minimum(apart, nearer, out=apart)
        chosen.append(pose)
        if not waiting and len(chosen) < len(poses) // FRAMES_PER_POSE:
            farthest = int(np.argmax(apart))
            waiting = [farthest] if apart[farthest] > TOLERANCE**2 else []
    rows = np.column_stack(
        [frames[chosen], _radii(poses, chosen, stands_for), vectors[frames[chosen]]]
    )
    return rows[np.argsort(chosen)].astype(np.float32)


def _radii(poses: FloatArray, chosen: list[int], stands_for: IntArray) -> FloatArray:
    """(k,) the largest distance of each chosen pose to the `poses` that it represents."""
    apart = poses - poses[chosen][stands_for]
    radii = np.zeros(len(chosen))
    np.maximum.at(radii, stands_for, np.sqrt(np.vecdot(apart, apart)))
    return radii + _MARGIN
