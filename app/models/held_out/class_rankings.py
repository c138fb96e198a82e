"""Figures of rankings by class (Sun 2011, section 5).

Each query of a class ranks the other items. The figures are the usual ones of query by example, the
true-positive rate of table 1 and the confusion matrix of figure 8. The last two use the k nearest
items. If a class has fewer relevant items than k, they use as many as there are relevant items.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.models.held_out.ranking import average_precision
from app.numerics.arrays import FloatArray, IntArray

DEPTHS = (1, 4, 20)
"""Numbers of nearest items for which the precision is computed."""


@dataclass(frozen=True, slots=True)
class JudgedRanking:
    """The figures of one query, with C classes.

    own: class of the query; precision: (3,) among the DEPTHS nearest items; average_precision:
    Takano's eq. 20; true_positives: share of the query's class among the k nearest of all
    items; retrieved: (C,) share of each class among the k nearest items of the C classes.
    """

    own: int
    precision: FloatArray
    average_precision: float
    true_positives: float
    retrieved: FloatArray


def judge_ranking(ranked: IntArray, own: int, classes: int, k: int) -> JudgedRanking:
    """Judge the ranking of one query.

    ranked: (n,) the class index of each item in order, `classes` for an item that is in none of
    the C classes; without the query itself. Raises ValueError if no item has the class `own`.
    """
    is_relevant = ranked == own
    relevant = int(is_relevant.sum())
    if not relevant:
        raise ValueError("a query without relevant items cannot be judged")
    depth = min(k, relevant)
    nearest = ranked[ranked < classes][:depth]
    return JudgedRanking(
        own=own,
        precision=np.array([is_relevant[:count].mean() for count in DEPTHS]),
        average_precision=average_precision(-np.arange(float(len(ranked))), is_relevant),
        true_positives=float(is_relevant[:depth].mean()),
        retrieved=np.bincount(nearest, minlength=classes) / len(nearest),
    )


def true_positive_rates(judged: Sequence[JudgedRanking], classes: int) -> FloatArray:
    """(C,) mean true-positive rate of the queries of each class; 0 for a class without queries."""
    return _mean_by_class(judged, np.array([[one.true_positives] for one in judged]), classes)[:, 0]


def confusion_matrix(judged: Sequence[JudgedRanking], classes: int) -> FloatArray:
    """(C, C): each row is the mean `retrieved` of the queries of a class.

    Rows sum to 1; the row of a class without queries is 0.
    """
    return _mean_by_class(judged, np.stack([one.retrieved for one in judged]), classes)


def _mean_by_class(judged: Sequence[JudgedRanking], values: FloatArray, classes: int) -> FloatArray:
    own = np.array([one.own for one in judged])
    sums = np.zeros((classes, values.shape[1]))
    np.add.at(sums, own, values)
    return np.asarray(sums / np.maximum(np.bincount(own, minlength=classes), 1)[:, None])
