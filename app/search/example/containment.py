"""How nearly one of two motions is a part of the other, at any tempo.

A clip that is played faster, cut, or repeated is far from its original by the motion vector and by
warping of the whole. But its poses are those of the original, in the same order.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.analysis.descriptors.frame_features import POSITIONS
from app.numerics.alignment.partial_dtw import Limits, partial_distances
from app.numerics.arrays import FloatArray
from app.search.example.distances import ACTIVE, FEATURES, Descriptors, Loader, active_frames

STILL = 0.05
"""Added to the movement of a motion, in body lengths. So two rests need not agree to the last
millimeter, and a rest is a part of a motion only if it is one of its poses."""


def containment_distances(
    query: Descriptors, clip_ids: Sequence[str], load: Loader, limit: float = np.inf
) -> FloatArray:
    """(n,) distances of clips to a query: 0 if one of both is a part of the other.

    The poses of the motion that is the part differ by this share of its own movement: the root
    mean square of its distances to its mean pose. About 1 for motions that have nothing in common.
    limit: infinity may stand for a distance from this one on. A clip without the arrays (it was
    deleted during the search) has the distance infinity.
    """
    features, spans = load(clip_ids, FEATURES), load(clip_ids, ACTIVE)
    rows = [row for row, one in enumerate(clip_ids) if one in features and one in spans]
    ids = [clip_ids[row] for row in rows]
    clips = [_poses(features[one], spans[one]) for one in ids]
    own = _poses(query[FEATURES], query[ACTIVE])
    moved, movements = _movement(own), np.array([_movement(clip) for clip in clips])
    apart = partial_distances(own, clips, Limits(limit * moved, limit * movements))
    found = np.full(len(clip_ids), np.inf)
    found[rows] = np.minimum(apart.inside / moved, apart.around / movements)
    return found


def _poses(features: FloatArray, span: FloatArray) -> FloatArray:
    """(m, 39) the positions of the active part."""
    return active_frames(features, span)[:, POSITIONS]


def _movement(poses: FloatArray) -> float:
    moved = poses - poses.mean(axis=0)
    return float(np.sqrt(np.vecdot(moved, moved).mean())) + STILL
