"""How well rankings keep classes together (Sun 2011, section 5).

Each query of a class ranks other items. Told are the usual figures of query by example, the
true-positive rate of table 1 and the confusion of figure 8. The last two look at the k
nearest; a class of fewer items cannot fill them, however good the ranking, so that as many
are looked at as there are relevant ones, and k at most.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.models.held_out.ranking import average_precision
from app.numerics.arrays import FloatArray, IntArray

DEPTHS = (1, 4, 20)
"""Precision is told among so many of the nearest."""


@dataclass(frozen=True, slots=True)
class JudgedRanking:
    """What one query found, of C classes.

    own: class of the query; precision: (3,) among the DEPTHS nearest; average_precision:
    Takano's eq. 20; true_positives: share of the query's class among the k nearest of
    everything; retrieved: (C,) share of each class among the k nearest of the C classes.
    """

    own: int
    precision: FloatArray
    average_precision: float
    true_positives: float
    retrieved: FloatArray


def judge_ranking(found: IntArray, own: int, classes: int, k: int) -> JudgedRanking:
    """`found` (n,): the classes in the order found, `classes` for one that is none of the C.

    The query itself is not in it. Raises ValueError where nothing of class `own` is.
    """
    is_relevant = found == own
    relevant = int(is_relevant.sum())
    if not relevant:
        raise ValueError("a query without anything relevant cannot be judged")
    depth = min(k, relevant)
    nearest = found[found < classes][:depth]
    return JudgedRanking(
        own=own,
        precision=np.array([is_relevant[:place].mean() for place in DEPTHS]),
        average_precision=average_precision(-np.arange(float(len(found))), is_relevant),
        true_positives=float(is_relevant[:depth].mean()),
        retrieved=np.bincount(nearest, minlength=classes) / len(nearest),
    )


def true_positive_rates(judged: Sequence[JudgedRanking], classes: int) -> FloatArray:
    """(C,) mean over the queries of each class; 0 for a class that has none."""
    return _mean_by_class(judged, np.array([[one.true_positives] for one in judged]), classes)[:, 0]


def confusion_matrix(judged: Sequence[JudgedRanking], classes: int) -> FloatArray:
    """(C, C): row by row, what the queries of a class retrieved; rows sum to 1, or 0 without."""
    return _mean_by_class(judged, np.stack([one.retrieved for one in judged]), classes)


def _mean_by_class(judged: Sequence[JudgedRanking], values: FloatArray, classes: int) -> FloatArray:
    own = np.array([one.own for one in judged])
    sums = np.zeros((classes, values.shape[1]))
    np.add.at(sums, own, values)
    return np.asarray(sums / np.maximum(np.bincount(own, minlength=classes), 1)[:, None])
