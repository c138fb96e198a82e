"""Covariance of the takes within a cell, for each task, with a factor for each person.

In takes of a wave, the hand moves at different times. Takes of a walk hardly differ. With one
covariance for all cells, every walk would look known, and half of the waves would look new. So each
task has its own covariance, shrunk toward the pooled one. Its size needs fewer takes than its
shape, since all d numbers of a take contribute to the size. The takes of one person may also differ
less than those of others, in all tasks. A factor on the covariance models this.

Shapes: deviations (n, d) of n takes from the means of their cells, in the coordinates of one view.
The shrinkage of class covariances toward the pooled one is regularized discriminant analysis
(Friedman 1989); the separate shrinkage of size and shape, and the factor of persons, are our own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.models.cells import Cells
from app.numerics.arrays import FloatArray, IntArray

PRIOR_OF_SIZE = 5.0
"""Weight of the pooled size of a covariance, in repeated takes."""

PRIOR_OF_SHAPE = 10.0
"""Weight of the pooled shape of a covariance, in repeated takes."""

MAX_FORMS = 256
"""Largest number of tasks with their own covariance: the tasks with the most repeated takes. The
others have the pooled shape. (The whiteners take 7 MB in 60 dimensions.)"""


@dataclass(frozen=True, slots=True)
class Scatter:
    """The covariance of each cell.

    covariances: F matrices (d, d), the last one is the pooled one; form: (cells,) the index of
    each cell's covariance; spread: (cells,) the factor on it.
    """

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
    """The covariances within cells.

    deviations: (n, d) of takes from the means of their cells; member: (n,) the cell of each
    take, all with both labels; pooled: (d, d) the covariance of all deviations, n > cells.
    Raises LinAlgError if `pooled` is not positive definite.
    """
    factor = np.linalg.cholesky(pooled)
    white = np.linalg.solve(factor, deviations.T).T
    # n takes have n - 1 degrees of freedom
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
    # The last entry is for cells without a task (index -1), as is the appended 1.0 below.
    form = np.full(len(cells.tasks) + 1, len(own))
    form[own] = np.arange(len(own))
    spread = np.append(of_task, 1.0)[cells.task] * np.append(of_person, 1.0)[cells.person]
    covariances = [factor @ shape @ factor.T for shape in shapes]
    return Scatter([*covariances, pooled], form[cells.task], spread)


def _sizes(squares: FloatArray, weight: FloatArray, label: IntArray, labels: int) -> FloatArray:
    """(labels,) mean square of each label's takes (1 is the average), shrunk toward 1."""
    total = np.bincount(label, squares, minlength=labels)
    return np.asarray(
        (PRIOR_OF_SIZE + total) / (PRIOR_OF_SIZE + np.bincount(label, weight, minlength=labels))
    )


def _shape(white: FloatArray, freedom: float) -> FloatArray:
    """(d, d) covariance with mean variance 1, of a task's deviations `white` (n, d), which are
    whitened by the pooled covariance."""
    dimensions = white.shape[1]
    scatter = white.T @ white
    size = max(float(np.trace(scatter)), 1e-12)
    share = freedom / (freedom + PRIOR_OF_SHAPE)
    return np.asarray((1 - share) * np.eye(dimensions) + share * dimensions / size * scatter)
