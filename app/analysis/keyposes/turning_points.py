"""Turning points: the far ends of movements that leave a pose and return to it.

A strike does not come to rest where it hits: the limb turns back. So a kick has no keypose of
Perera's two kinds but the stances before and after it. But seen from the waist, the body returns to
the pose that it left. Of the poses between, the farthest one is where the movement turns.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from app.numerics.arrays import FloatArray

MAX_RETURN = 0.6
"""The largest distance of the poses before and after, as a share of that of the farthest pose. In
recorded kicks and punches it is below 0.5, in movements to another pose above 0.9."""

MIN_REACH = 0.08
"""Body lengths, the root mean square over joints: the smallest distance of the farthest pose."""


def turning_points(poses: FloatArray, bounds: Sequence[int]) -> list[int]:
    """The frames of the turning points between each two neighboring `bounds`, rising.

    poses: (n, joints, 3) positions as seen from the waist, in body lengths. bounds: frames of
    poses that may be left and returned to, rising.
    """
    found = []
    for left, right in pairwise(bounds):
        between = poses[left : right + 1]
        # (frames,) the distance from the nearer of both poses
        away = np.minimum(_distances(between, poses[left]), _distances(between, poses[right]))
        farthest = int(away.argmax())
        returned = float(_distances(poses[right : right + 1], poses[left])[0])
        if away[farthest] >= MIN_REACH and returned <= MAX_RETURN * away[farthest]:
            found.append(left + farthest)
    return found


def _distances(poses: FloatArray, pose: FloatArray) -> FloatArray:
    """(n,) the root mean square distance of the joints of `poses` (n, joints, 3) from `pose`."""
    return np.asarray(np.sqrt(np.square(poses - pose).sum(axis=-1).mean(axis=-1)))
