"""Flat PCA, the baseline with which Vasilescu 2002 (section 5) compares her model.

Each observed motion is a vector of coefficients of the principal axes. A person has one vector for
each task. (The multilinear model has one signature for each person.) So flat PCA does not model
what two tasks of one person have in common.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.errors import NotEnoughLabels
from app.models.cells import Cells, cell_means, even_cells, find_cells
from app.models.recognition.answers import Recognition, answer, given
from app.models.recognition.multilinear import DIMENSIONS, MAX_TAKES, shares
from app.numerics.arrays import FloatArray, IntArray
from app.numerics.principal_axes import PrincipalAxes, principal_axes


@dataclass(frozen=True, slots=True)
class FlatPCA:
    """cells: the pairs of person and task that were recorded; coefficients: (cells, k) the mean
    of each cell's takes, in the k coordinates of `axes`."""

    cells: Cells
    axes: PrincipalAxes
    coefficients: FloatArray


def fit_flat_pca(
    samples: FloatArray,
    persons: Sequence[str | None],
    tasks: Sequence[str | None],
    dimensions: int = DIMENSIONS,
) -> FlatPCA:
    """Fit on samples (clips, w) that have both labels. Raises NotEnoughLabels without any."""
    use = even_cells(persons, tasks, MAX_TAKES)
    if not use:
        raise NotEnoughLabels("Flat PCA needs clips with a person and a task.")
    cells = find_cells([persons[i] for i in use], [tasks[i] for i in use])
    axes = principal_axes(np.asarray(samples)[use], dimensions)
    return FlatPCA(cells, axes, cell_means(axes.project(np.asarray(samples)[use]), cells))


def recognize_flat(
    record: FlatPCA,
    sample: FloatArray,
    known_person: str | None = None,
    known_task: str | None = None,
) -> Recognition:
    """Recognize who does what in one sample (w,) by the nearest cell.

    Only the cells of a known person or task are compared; a known label that the model does
    not have is ignored. Nothing is called unknown. Scores are shares by nearness.
    """
    cells = record.cells
    distances = np.linalg.norm(record.coefficients - record.axes.project(sample), axis=1)
    to_persons = _nearest(_among(distances, cells.task, cells.tasks, known_task), cells.person)
    to_tasks = _nearest(_among(distances, cells.person, cells.persons, known_person), cells.task)
    return Recognition(
        given(known_person, cells.persons)
        if known_person
        else answer(cells.persons, shares(to_persons), known=True),
        given(known_task, cells.tasks)
        if known_task
        else answer(cells.tasks, shares(to_tasks), known=True),
    )


def _among(
    distances: FloatArray, label: IntArray, names: tuple[str, ...], known: str | None
) -> FloatArray:
    """The distances (cells,); those of cells with another label than `known` are infinite."""
    if known not in names:
        return distances
    return np.where(label == names.index(known), distances, np.inf)


def _nearest(distances: FloatArray, label: IntArray) -> FloatArray:
    """(labels,) the smallest of the `distances` (cells,) of each label's cells."""
    smallest = np.full(int(label.max()) + 1, np.inf)
    np.minimum.at(smallest, label, distances)
    return smallest
