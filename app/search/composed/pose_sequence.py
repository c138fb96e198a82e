"""How near clips come to a sequence of poses, one after the other: "from this to that".

The distance is the least mean distance of the poses to frames in the same order. The pose covers of
the clips (`search.pose.by_pose`) give a lower bound of it, without the order, for every clip. The
clips with the least bounds are measured frame by frame.
"""

from __future__ import annotations

import numpy as np

from app.numerics.arrays import FloatArray, IntArray
from app.search.composed.by_parts import Evidence, SecondStage
from app.search.composed.likeness import Curve
from app.search.composed.surprise import Part
from app.search.example.distances import Loader
from app.search.index.labels import LabelView
from app.search.index.rows import RowsView
from app.search.pose.by_pose import POSITIONS, pose_bounds, pose_distances
from app.search.ranking.lower_bounds import LowerBounds
from app.search.ranking.ranking import IdArray

CURVE = Curve(0.15, 4.0)
"""The probability that a clip takes the poses, by the mean distance in body lengths. Chosen, not
fitted: a search by pose has half of its score at .25, where clips do not contain a pose."""
_FAR = 1e6
"""The distance of clips without poses."""


def same_clips(labels: LabelView, ids: IdArray, numbers: IntArray, others: LabelView) -> IntArray:
    """(k,) the numbers in another index of the clips `ids` (k,), which are `numbers` in this one.

    -1 for clips that the other one lacks. Indexes that loaded the same changes agree.
    """
    if len(labels.ids) == len(others.ids) and np.array_equal(labels.ids, others.ids):
        return np.where(others.alive[numbers], numbers, -1)
    return others.find(ids)


def pose_evidence(
    part: Part, poses: FloatArray, view: RowsView, places: IntArray, load: Loader
) -> Evidence:
    """The probabilities that clips take poses in this order.

    poses: (p, 36) vectors; view: of an index of poses; places: (k,) the numbers of the clips in it,
    -1 for none; load: loads POSITIONS.
    """
    bounds = np.mean([pose_bounds(view, pose) for pose in poses], axis=0)
    far = np.full(len(places), _FAR)
    far[places >= 0] = bounds[places[places >= 0]]
    exact = poses.astype(np.float64)

    def measured(ids: IdArray) -> LowerBounds:
        def measure(chosen: IntArray) -> FloatArray:
            stored = load(ids[chosen].tolist(), POSITIONS)
            return np.array(
                [
                    sequence_match(frame_distances(stored[one], exact))[0]
                    if one in stored
                    else np.inf
                    for one in ids[chosen]
                ]
            )

        return LowerBounds(ids, np.zeros(len(ids)), measure)

    return Evidence(part, _likely(far), SecondStage(measured, _likely))


def frame_distances(positions: FloatArray, poses: FloatArray) -> FloatArray:
    """(p, n) distances of poses (p, 36) to the frames of positions (n, 13, 3), body lengths."""
    return np.stack([pose_distances(positions, pose) for pose in poses])


def sequence_match(distances: FloatArray) -> tuple[float, list[int]]:
    """The least mean distance of p poses to frames that never go back, and these frames.

    distances: (p, n) of each pose to each frame.
    """
    best, earlier = distances[0], []
    for own in distances[1:]:
        # for each frame, the best frame so far of the poses before
        places = np.where(best == np.minimum.accumulate(best), np.arange(len(best)), 0)
        places = np.maximum.accumulate(places)
        earlier.append(places)
        best = best[places] + own
    frame = int(np.argmin(best))
    frames = [frame]
    for places in reversed(earlier):
        frames.append(int(places[frames[-1]]))
    return float(best[frame]) / len(distances), frames[::-1]


def _likely(distances: FloatArray) -> FloatArray:
    return CURVE.probabilities(distances, 1.0)
