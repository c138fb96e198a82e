"""Cells: the takes of one task by one person, and the prediction of missing cells.

In most libraries, not every person does every task. A missing cell is predicted as the sum of a
person effect and a task effect, which ridge regression fits. This is deterministic, and stable even
if few cells overlap. A low-rank N-mode model that was iterated from there (EM) predicted held-out
real cells less well.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.numerics.arrays import BoolArray, FloatArray, IntArray

EFFECT_RIDGE = 0.5
"""Ridge penalty of an effect, in cells. It also makes effects unique if the data cannot separate
them."""


@dataclass(frozen=True, slots=True)
class Cells:
    """The cell of each clip.

    persons, tasks: sorted labels; member: (clips,) cell of each clip, -1 without any label;
    person, task: (cells,) index of the label, -1 without the label; takes: (cells,) number of
    clips. Each clip with only one of the labels has a cell of its own.
    """

    persons: tuple[str, ...]
    tasks: tuple[str, ...]
    member: IntArray
    person: IntArray
    task: IntArray
    takes: IntArray

    def __len__(self) -> int:
        return len(self.takes)

    @property
    def full(self) -> BoolArray:
        """(cells,) whether the cell has both labels."""
        return (self.person >= 0) & (self.task >= 0)


def find_cells(persons: Sequence[str | None], tasks: Sequence[str | None]) -> Cells:
    """The cells of clips with the labels `persons`, `tasks` (clips,); None or "" is no label."""
    person_names, person = _indexed(persons)
    task_names, task = _indexed(tasks)
    partial = (person < 0) | (task < 0)
    # a number for each partly labeled clip, so that no two of them share a cell
    own = np.where(partial, np.arange(1, len(person) + 1), 0)
    labeled = (person >= 0) | (task >= 0)
    keys = np.stack([person, task, own], axis=1)[labeled]
    unique, inverse = np.unique(keys, axis=0, return_inverse=True)
    member = np.full(len(person), -1)
    member[labeled] = inverse.reshape(-1)
    takes = np.bincount(member[labeled], minlength=len(unique))
    return Cells(person_names, task_names, member, unique[:, 0], unique[:, 1], takes)


def even_cells(persons: Sequence[str | None], tasks: Sequence[str | None], most: int) -> list[int]:
    """Ascending indices of the clips with both labels, or `even_takes` of their cells, if there are
    more than `most`; persons, tasks: (clips,)."""
    both = [i for i, labels in enumerate(zip(persons, tasks, strict=True)) if all(labels)]
    if len(both) <= most:
        return both
    cells = find_cells([persons[i] for i in both], [tasks[i] for i in both])
    return [both[i] for i in even_takes(cells, most)]


def cell_means(points: FloatArray, cells: Cells) -> FloatArray:
    """(cells, d) means of `points` (clips, d)."""
    if not len(cells):
        return np.zeros((0, points.shape[1]))
    # every cell has a take, so none of the sums is empty
    order = np.argsort(cells.member, kind="stable")[np.count_nonzero(cells.member < 0) :]
    starts = np.cumsum(cells.takes) - cells.takes
    sums = np.add.reduceat(np.asarray(points, dtype=np.float64)[order], starts, axis=0)
    return np.asarray(sums / cells.takes[:, None])


def even_takes(cells: Cells, most: int) -> IntArray:
    """Ascending indices of at most `most` labeled clips, but of at least one take of each cell.

    A cell with more takes than fit gives some of them, evenly spread in the order of the clips:
    after the first dozens, a further take of a cell hardly changes its mean.
    """
    order = np.argsort(cells.member, kind="stable")[np.count_nonzero(cells.member < 0) :]
    if len(order) <= most:
        return np.sort(order)
    each = 1
    while np.minimum(cells.takes, each + 1).sum() <= most:
        each += 1
    chosen = [
        members[np.linspace(0, len(members) - 1, min(len(members), each)).astype(np.int64)]
        for members in np.split(order, np.cumsum(cells.takes)[:-1])
    ]
    return np.sort(np.concatenate(chosen))


@dataclass(frozen=True, slots=True)
class Effects:
    """Person and task effects: a prediction is mean + row of `persons` + row of `tasks`.

    mean: (d,); persons: (P, d); tasks: (T, d); errors: (full cells, d), each cell minus its
    prediction from all other cells.
    """

    mean: FloatArray
    persons: FloatArray
    tasks: FloatArray
    errors: FloatArray

    def predict(self, person: IntArray, task: IntArray) -> FloatArray:
        """(n, d) predictions for the pairs `person`, `task`, label indices (n,) each."""
        return np.asarray(self.mean + self.persons[person] + self.tasks[task])


def fit_effects(means: FloatArray, cells: Cells, ridge: float = EFFECT_RIDGE) -> Effects:
    """Person and task effects, by ridge regression on the full cells.

    means: (cells, d) of `cell_means`. ridge: the penalty, in cells; the mean has none.
    """
    full = np.flatnonzero(cells.full)
    count, persons = len(full), len(cells.persons)
    design = np.zeros((count, 1 + persons + len(cells.tasks)))
    design[:, 0] = 1
    design[np.arange(count), 1 + cells.person[full]] = 1
    design[np.arange(count), 1 + persons + cells.task[full]] = 1
    penalty = np.full(design.shape[1], ridge)
    penalty[0] = 1e-9  # the mean is not penalized, but the matrix must be invertible
    solver = np.linalg.solve(design.T @ design + np.diag(penalty), design.T)
    effects = solver @ means[full]
    # A residual divided by 1 - leverage is the error of a fit without that cell.
    leverage = np.einsum("ij,ji->i", design, solver)
    errors = (means[full] - design @ effects) / np.maximum(1 - leverage, 1e-6)[:, None]
    return Effects(effects[0], effects[1 : 1 + persons], effects[1 + persons :], errors)


def _indexed(labels: Sequence[str | None]) -> tuple[tuple[str, ...], IntArray]:
    """The distinct labels, sorted, and (n,) the index of each label, -1 for None or ""."""
    names = tuple(sorted({label for label in labels if label}))
    index_of = {name: index for index, name in enumerate(names)}
    return names, np.array([index_of[label] if label else -1 for label in labels], dtype=np.int64)
