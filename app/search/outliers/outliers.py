"""Clips that differ from the others with their label: far away, or with sides exchanged.

Far: the distance to the nearest clips of the label is compared with that of the label's other
clips, by the median and the median absolute deviation (Iglewicz and Hoaglin 1993, the modified
z-score). The label of the nearest other clips is suggested if they are nearer. Swapped: nearly all
clips of a label move the same side more, and this clip moves the other one.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from app.deadline import check
from app.numerics.arrays import FloatArray, IntArray
from app.numerics.euclidean import squared_distances


class OutlierReason(StrEnum):
    """Why a clip is an outlier within its label."""

    FAR = "far"
    """It is far from the other clips with the label."""
    SWAPPED = "swapped"
    """It moves the other side: left and right may be exchanged in the motion or in the labels."""


MIN_CLIPS = 5
"""Clips of a label, without the one that is judged. Fewer do not say what is usual."""

NEIGHBORS = 3
"""Nearest clips whose mean distance counts."""

MAX_OTHERS = 2000
"""Clips of a label with which each is compared; of more, evenly spaced ones."""

FAR = 3.5
"""The modified z-score from which a clip is far (Iglewicz and Hoaglin's value)."""

_SCALE = 0.6745
LEAST_SPREAD = 0.1
"""The least spread, as a share of the median: takes of an actor differ as little as copies."""

ONE_SIDED, SAME_SIDE = 0.3, 0.8
"""The dominance of a side from which a label is one-sided, and the share of clips that have it."""


@dataclass(frozen=True, slots=True)
class Outlier:
    """A clip by its number.

    score: how unusual it is, more is worse: the modified z-score, or the difference of dominance.
    value, usual: of the clip, and the median of its label: distances to the nearest clips, or
    dominance. suggested: the code of the label of the nearest other clips, None without one.
    """

    number: int
    reason: OutlierReason
    score: float
    value: float
    usual: float
    suggested: int | None = None


def far_ones(vectors: FloatArray, codes: IntArray) -> list[Outlier]:
    """The clips that are far from their label.

    vectors: (n, d). codes: (n,) of the labels, negative for a clip without one.
    """
    found: list[Outlier] = []
    for code in np.unique(codes[codes >= 0]).tolist():
        members = np.flatnonzero(codes == code)
        if len(members) <= MIN_CLIPS:
            continue
        check()
        own = _nearest_mean(vectors, members, members[_spaced(len(members))])
        usual = float(np.median(own))
        spread = float(np.median(np.abs(own - usual)))
        scores = _SCALE * (own - usual) / max(spread, LEAST_SPREAD * usual, 1e-9)
        for place in np.flatnonzero(scores > FAR).tolist():
            number = int(members[place])
            suggested = _suggestion(vectors, codes, number, float(own[place]))
            found.append(
                Outlier(
                    number,
                    OutlierReason.FAR,
                    float(scores[place]),
                    float(own[place]),
                    usual,
                    suggested,
                )
            )
    return found


def swapped_ones(dominance: FloatArray, codes: IntArray) -> Iterator[Outlier]:
    """The clips that move the side that their label does not.

    dominance: (n,) of the left side, NaN where unknown. codes: (n,) of the labels.
    """
    for code in np.unique(codes[codes >= 0]).tolist():
        members = np.flatnonzero((codes == code) & np.isfinite(dominance))
        if len(members) <= MIN_CLIPS:
            continue
        values = dominance[members]
        usual = float(np.median(values))
        side = np.sign(usual)
        if abs(usual) < ONE_SIDED or (values * side > 0).mean() < SAME_SIDE:
            continue
        for place in np.flatnonzero(values * side < -ONE_SIDED).tolist():
            value = float(values[place])
            yield Outlier(
                int(members[place]), OutlierReason.SWAPPED, abs(value - usual), value, usual
            )


def _spaced(count: int) -> IntArray:
    return np.unique(np.linspace(0, count - 1, min(count, MAX_OTHERS)).round().astype(np.int64))


def _nearest_mean(vectors: FloatArray, members: IntArray, others: IntArray) -> FloatArray:
    """(m,) the mean distance of each member to its nearest NEIGHBORS among `others`."""
    target = np.ascontiguousarray(vectors[others], dtype=np.float64)
    squares = np.square(target).sum(axis=1)
    found = np.empty(len(members))
    for first in range(0, len(members), MAX_OTHERS):
        rows = members[first : first + MAX_OTHERS]
        away = squared_distances(vectors[rows].astype(np.float64), target, squares)
        away[rows[:, None] == others] = np.inf
        nearest = np.partition(away, NEIGHBORS - 1, axis=1)[:, :NEIGHBORS]
        found[first : first + len(rows)] = np.sqrt(np.maximum(nearest, 0.0)).mean(axis=1)
    return found


def _suggestion(vectors: FloatArray, codes: IntArray, number: int, own: float) -> int | None:
    """The commonest label of the nearest clips with another label, if those are nearer."""
    others = np.flatnonzero((codes >= 0) & (codes != codes[number]))
    if len(others) < NEIGHBORS:
        return None
    away = np.linalg.norm(vectors[others].astype(np.float64) - vectors[number], axis=1)
    nearest = np.argsort(away, kind="stable")[:NEIGHBORS]
    if away[nearest].mean() >= own:
        return None
    labels, counts = np.unique(codes[others[nearest]], return_counts=True)
    return int(labels[np.argmax(counts)])
