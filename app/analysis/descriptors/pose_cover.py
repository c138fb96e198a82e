"""Few poses of a clip that stand for all of them: the coarse index of pose search.

Starting from the keyposes, the pose that is farthest from all that were chosen is chosen
next, until none is farther than TOLERANCE (farthest-point traversal: Gonzalez 1985, at most
twice the poses that the best choice would need). Each keeps how far the poses that it
stands for may be from it, so that a search can tell which clips it need not look into.
"""

from __future__ import annotations

import numpy as np

from app.motion.frame.body_pose import body_poses
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray, IntArray

POSE_WIDTH = 36
"""Numbers of a pose: 12 joints in the body frame, without the hips, which are its origin."""

TOLERANCE = 0.05
"""Body lengths: how far a pose may be from the one that stands for it."""

FRAMES_PER_POSE = 8
"""At most one pose in so many frames is chosen: fast movement is covered more coarsely."""

CHUNK = 1800
"""Frames that are covered together: the cost grows with their number times that of the poses."""

_MARGIN = 1e-6
"""Added to radii, for float32's rounding."""

_JOINTS = [index for index, role in enumerate(SUN_ROLES) if role is not JointRole.HIPS]


def pose_vectors(positions: FloatArray) -> FloatArray:
    """(n, 36) float32: poses whose Euclidean distance is the RMS distance of their joints.

    positions: (n, 13, 3) in SUN_ROLES order, any unit, Y up. Distances are body lengths, in
    each pose's own body frame. Joints weigh alike: on 228 clips heavier hands, feet or trunk
    moved the precision at 5 by less than .02 either way. A pose of no size is NaN.
    """
    planes = body_poses(positions).T[:, _JOINTS]  # (3, 12, n), contiguous
    planes /= np.sqrt(len(_JOINTS))
    return np.asarray(planes.astype(np.float32).T.reshape(-1, POSE_WIDTH))


def pose_cover(positions: FloatArray, keyposes: IntArray) -> FloatArray:
    """(k, 38) float32: frame, radius (body lengths) and vector of each chosen pose.

    positions: (n, 13, 3); keyposes: (m,) frames, all of which are chosen. Rows rise by frame.
    Every pose of the clip is within the radius of one of them; poses of no size are left out.
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
    """(k, 38): the cover of some `frames` (m,) of `vectors` (n, 36); keyposes among the m."""
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
    """(k,) how far the farthest of the `poses` that each chosen one stands for is from it."""
    apart = poses - poses[chosen][stands_for]
    radii = np.zeros(len(chosen))
    np.maximum.at(radii, stands_for, np.sqrt(np.vecdot(apart, apart)))
    return radii + _MARGIN
