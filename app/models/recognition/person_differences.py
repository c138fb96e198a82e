"""How much persons differ at a task, and how this depends on the task.

Two persons who dance differ (in variance) ten times as much as two persons who walk. Takes of one
person do so too. With one size for all tasks, a stranger who walks is nearer to a known person
than two persons usually are, and is called that person. So each task has a size.

The sizes and the covariance of differences of size 1 depend on each other, and are found in turn.
A size is shrunk toward 1 on a logarithmic scale, because sizes are factors. Our own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.models.cells import Cells
from app.models.recognition.shrunk import shrunk
from app.numerics.arrays import FloatArray, IntArray

MIN_CELLS = 5
"""With fewer cells of tasks that several persons do, the differences are not estimated."""

PRIOR_OF_SIZE = 2.0
"""Weight of the size 1, in persons. Of 2 and 8, 2 told more new persons from known ones in
libraries with one take of each cell, by cross-validation."""

ROUNDS = 10
"""How often sizes and covariance are computed in turn; 10 give the sizes to 1 %."""


@dataclass(frozen=True, slots=True)
class PersonDifferences:
    """The differences between the cells of two persons at one task.

    covariance: (d, d) at a task of size 1; size: (tasks + 1,) the factor on it for each task. The
    last entry, 1, is for cells without a task (index -1).
    """

    covariance: FloatArray
    size: FloatArray


def person_differences(means: FloatArray, cells: Cells, fallback: FloatArray) -> PersonDifferences:
    """The differences, from the `means` (cells, d) of the cells.

    fallback: (d, d) the covariance if there are fewer than MIN_CELLS cells of tasks that
    several persons do; all sizes are then 1.
    """
    labels = len(cells.tasks)
    counts = np.bincount(cells.task[cells.task >= 0], minlength=labels)
    shared = np.flatnonzero(np.append(counts > 1, False)[cells.task])
    if len(shared) < MIN_CELLS:
        return PersonDifferences(fallback, np.ones(labels + 1))
    task = cells.task[shared]
    deviations = means[shared] - label_centers(means, cells.task, labels)[task]
    size, covariance = _sizes(deviations, 1 - 1 / counts[task], task, labels)
    # the difference of two persons has twice the covariance of one person about the mean
    return PersonDifferences(shrunk(2 * covariance), np.append(size, 1.0))


def label_centers(means: FloatArray, label: IntArray, labels: int) -> FloatArray:
    """(labels, d) the mean of each label's cells; label: (cells,), -1 for none."""
    has = np.flatnonzero(label >= 0)
    centers = np.zeros((labels, means.shape[1]))
    np.add.at(centers, label[has], means[has])
    return np.asarray(centers / np.maximum(np.bincount(label[has], minlength=labels), 1)[:, None])


def _sizes(
    deviations: FloatArray, freedom: FloatArray, label: IntArray, labels: int
) -> tuple[FloatArray, FloatArray]:
    """(labels,) sizes, and the covariance (d, d) of deviations of size 1.

    deviations: (n, d) from the mean of their label; freedom, label: (n,) each. The logarithms of
    the sizes have the weighted mean 0 in each round.
    """
    weight = np.bincount(label, freedom, minlength=labels)
    has = weight > 0
    share = weight[has] / (weight[has] + PRIOR_OF_SIZE)
    size = np.ones(labels)
    for _ in range(ROUNDS):
        factor = np.linalg.cholesky(shrunk(_covariance(deviations, freedom, size[label])))
        squares = (np.linalg.solve(factor, deviations.T) ** 2).mean(axis=0)
        own = np.bincount(label, squares, minlength=labels)[has] / weight[has]
        logs = np.log(np.maximum(own, 1e-9))
        size[has] = np.exp(share * (logs - (share * logs).sum() / share.sum()))
    return size, _covariance(deviations, freedom, size[label])


def _covariance(deviations: FloatArray, freedom: FloatArray, size: FloatArray) -> FloatArray:
    scaled = deviations / np.sqrt(size)[:, None]
    return np.asarray(scaled.T @ scaled / freedom.sum())
