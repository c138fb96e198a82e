"""How takes of one cell differ from each other: of each task, and of each person, in their way.

One covariance for all cells takes every walk for like and half of the waves for strange: takes
of a wave differ in when the hand goes, of a walk hardly at all. So each task has its own, pulled
toward the pooled one: its size soon, since all d numbers of a take tell of it, its shape later.
A person may besides be more even than others, at whatever they do: a factor.

Shapes: deviations (n, d), of n takes from the means of their cells, in the coordinates of one
view. Covariances of classes drawn toward the pooled one are regularised discriminant analysis
(Friedman 1989); size and shape apart, and the factor of persons, are our own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.models.cells import Cells
from app.numerics.arrays import FloatArray, IntArray

PRIOR_OF_SIZE = 5.0
"""Repeated takes that the pooled size of a covariance counts as."""

PRIOR_OF_SHAPE = 10.0
"""Repeated takes that the pooled shape of a covariance counts as."""

MAX_FORMS = 256
"""Tasks with a covariance of their own, those of most repeated takes; the rest have the pooled
shape (7 MB of whitening in 60 dimensions)."""


@dataclass(frozen=True, slots=True)
class Scatter:
    """covariances: F times (d, d), the last one pooled; form: (cells,) which one each cell has;
    spread: (cells,) the factor on it."""

    covariances: list[FloatArray]
    form: IntArray
    spread: FloatArray

    @classmethod
    def same(cls, covariance: FloatArray, cells: Cells) -> Scatter:
        """One covariance (d, d) for all cells."""
        return cls([covariance], np.zeros(len(cells), dtype=np.int64), np.ones(len(cells)))


def scatter_within(
    deviations: FloatArray, member: IntArray, cells: Cells, pooled: FloatArray
) -> Scatter:
    """From takes' `deviations` (n, d) from the mean of their cells `member` (n,), all of which
    have both labels; pooled: (d, d) their covariance, n > cells.

    Raises LinAlgError where `pooled` is not positive definite.
    """
    factor = np.linalg.cholesky(pooled)
    white = np.linalg.solve(factor, deviations.T).T
    # n takes tell of n - 1 deviations
    weight = 1 - 1 / cells.takes[member]
    squares = (white**2).mean(axis=1)
    usual = max(float(squares.sum() / weight.sum()), 1e-12)
    task, person = cells.task[member], cells.person[member]
    of_task, of_person = (
        _sizes(squares / usual, weight, label, len(names))
        for label, names in ((task, cells.tasks), (person, cells.persons))
    )
    freedom = np.bincount(task, weight, minlength=len(cells.tasks))
    own = np.argsort(-freedom, kind="stable")[:MAX_FORMS]
    own = np.sort(own[freedom[own] > 0])
    shapes = [_shape(white[task == each], float(freedom[each])) for each in own]
    form = np.full(len(cells.tasks) + 1, len(own))
    form[own] = np.arange(len(own))
    spread = np.append(of_task, 1.0)[cells.task] * np.append(of_person, 1.0)[cells.person]
    covariances = [factor @ shape @ factor.T for shape in shapes]
    return Scatter([*covariances, pooled], form[cells.task], spread)


def _sizes(squares: FloatArray, weight: FloatArray, label: IntArray, labels: int) -> FloatArray:
    """(labels,) mean square of each label's takes, 1 being usual, pulled toward 1."""
    total = np.bincount(label, squares, minlength=labels)
    return np.asarray(
        (PRIOR_OF_SIZE + total) / (PRIOR_OF_SIZE + np.bincount(label, weight, minlength=labels))
    )


def _shape(white: FloatArray, freedom: float) -> FloatArray:
    """(d, d) of mean variance 1, from a task's deviations (n, d) whitened by the pooled one."""
    dimensions = white.shape[1]
    scatter = white.T @ white
    size = max(float(np.trace(scatter)), 1e-12)
    share = freedom / (freedom + PRIOR_OF_SHAPE)
    return np.asarray((1 - share) * np.eye(dimensions) + share * dimensions / size * scatter)
