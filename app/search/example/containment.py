"""How nearly one of two motions is a part of the other, at any tempo.

A clip that is played faster, cut, or repeated is far from its original by the motion vector and by
warping of the whole. But its poses are those of the original, in the same order. A take in another
file may have another skeleton, and then all poses differ by nearly the same. So the poses less
their mean are compared too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.analysis.descriptors.frame_features import POSITIONS
from app.numerics.alignment.partial_dtw import Limits, partial_distances
from app.numerics.arrays import FloatArray
from app.search.example.distances import ACTIVE, FEATURES, Descriptors, Loader, active_frames

STILL = 0.05
"""Added to the movement of a motion, in body lengths. So two rests need not agree to the last
millimeter, and a rest is a part of a motion only if it is one of its poses."""


@dataclass(frozen=True, slots=True)
class Containment:
    """Distances (n,) of clips to a query, 0 if one of both is a part of the other.

    The poses of the motion that is the part differ by this share of its own movement: the root
    mean square of its distances to its mean pose. About 1 for motions that have nothing in common.
    Infinity for clips without the arrays (they were deleted during the search).

    posed: of the poses. moved: of the poses less the mean pose of each motion, which is 0 for a
    take with other offsets, but not for a part with another mean pose.
    """

    posed: FloatArray
    moved: FloatArray

    @property
    def of_recordings(self) -> FloatArray:
        """(n,) the smaller one: small for a part, and for another file of the same take."""
        return np.minimum(self.posed, self.moved)


def containment(
    query: Descriptors, clip_ids: Sequence[str], load: Loader, limit: float = np.inf
) -> Containment:
    """How nearly the query and each clip are parts of each other.

    limit: infinity may stand for a distance from this one on.
    """
    features, spans = load(clip_ids, FEATURES), load(clip_ids, ACTIVE)
    rows = [row for row, one in enumerate(clip_ids) if one in features and one in spans]
    ids = [clip_ids[row] for row in rows]
    clips = [_poses(features[one], spans[one]) for one in ids]
    own = _poses(query[FEATURES], query[ACTIVE])
    posed, moved = np.full(len(clip_ids), np.inf), np.full(len(clip_ids), np.inf)
    posed[rows] = _shares(own, clips, limit)
    moved[rows] = _shares(_less_mean(own), [_less_mean(clip) for clip in clips], limit)
    return Containment(posed, moved)


def _shares(own: FloatArray, clips: Sequence[FloatArray], limit: float) -> FloatArray:
    """(c,) the distances of poses (m, 39) and of those of c clips, as shares of the movement."""
    movement, movements = _movement(own), np.array([_movement(clip) for clip in clips])
    apart = partial_distances(own, clips, Limits(limit * movement, limit * movements))
    return np.asarray(np.minimum(apart.inside / movement, apart.around / movements))


def _less_mean(poses: FloatArray) -> FloatArray:
    return np.asarray(poses - poses.mean(axis=0))


def _poses(features: FloatArray, span: FloatArray) -> FloatArray:
    """(m, 39) the positions of the active part."""
    return active_frames(features, span)[:, POSITIONS]


def _movement(poses: FloatArray) -> float:
    moved = poses - poses.mean(axis=0)
    return float(np.sqrt(np.vecdot(moved, moved).mean())) + STILL
