"""What synthesis learns of a library: the mean motion shape of each person at each task.

Means are taken of takes to one side (`synthesis_sides`) and of one course of time
(`synthesis_timing`), and only where they agree (`synthesis_agreement`): else one take, that most
like the others, stands for all. From them a person's motion is made for a task that they never
recorded (Vasilescu 2002, section 4): a new task comes to known persons, and every known task to a
person of whom there are only some clips. Both are one question, asked of `synthesis_prediction`:
solving eq. 7 for a signature among few persons came far less near to the truth. All is linear
within these choices, and deterministic.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.analysis.descriptors.motion_shape import SHAPE_LENGTH
from app.errors import NotEnoughLabels
from app.models.cells import Cells, find_cells
from app.models.synthesis.agreement import agree, agreement
from app.models.synthesis.basis import weights
from app.models.synthesis.sides import sides, to_side
from app.models.synthesis.timing import medoid, together
from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.numerics.principal_axes import PrincipalAxes, principal_axes

SYNTHESIS_VERSION = 2

DIMENSIONS = 64
"""Coordinates in which real clips are compared with what was made."""

MAX_CELLS = 20_000
"""Cells that are kept: some 220 MB."""


@dataclass(frozen=True, slots=True)
class Synthesis:
    """persons, tasks: sorted labels; means: (cells, 1378) mean motion shapes; person, task:
    (cells,) index of the label; takes: (cells,) clips of each; agreement: (cells,) how far they
    agree, below AGREED the mean is one of them.

    side: (cells,) to which a task is done, 0 where it is not of two sides; aligned: (cells, 1378)
    the means mirrored to the side +1 and in the task's time; timing: (cells, 32), see `Timed`.

    axes, points (N, 64), ids (N,), member (N,): the real clips' weighted shapes, among which the
    nearest to a made one is looked up, and the cell of each."""

    persons: tuple[str, ...]
    tasks: tuple[str, ...]
    means: FloatArray
    person: IntArray
    task: IntArray
    takes: IntArray
    agreement: FloatArray
    side: IntArray
    aligned: FloatArray
    timing: FloatArray
    axes: PrincipalAxes
    points: FloatArray
    ids: tuple[str, ...]
    member: IntArray

    def cell(self, person: str, task: str) -> FloatArray | None:
        """(1378,) the mean of a person's own takes of a task, None where there is none."""
        found = np.flatnonzero((self._of(person, self.persons) == self.person) & self.did(task))
        return np.asarray(self.means[found[0]]) if len(found) else None

    def cell_agreement(self, person: str, task: str) -> float | None:
        """How far a person's takes of a task agree, None where there are not two."""
        mine = (self._of(person, self.persons) == self.person) & self.did(task)
        found = np.flatnonzero(mine & (self.takes > 1))
        return float(self.agreement[found[0]]) if len(found) else None

    def reference(self, task: str) -> FloatArray:
        """(1378,) the mean of all persons' shapes of a task, to one side and in one time."""
        return np.asarray(self.aligned[self.did(task)].mean(axis=0))

    def is_two_sided(self, task: str) -> bool:
        """Whether a task is done to the one side by some and to the other by others."""
        return bool(self.side[self.did(task)].any())

    def tasks_of(self, person: str) -> dict[str, FloatArray]:
        """Mean shapes (1378,) of what a person did, by task."""
        cells = np.flatnonzero(self.person == self._of(person, self.persons))
        return {self.tasks[self.task[cell]]: self.means[cell] for cell in cells}

    def who_did(self, task: str) -> tuple[str, ...]:
        """The persons who did a task."""
        return tuple(self.persons[i] for i in sorted(self.person[self.did(task)]))

    def distances(self, shape: FloatArray) -> FloatArray:
        """(N,) how far the real clips are from a motion shape (1378,)."""
        return np.asarray(
            np.linalg.norm(self.points - self.axes.project(shape * weights()), axis=1)
        )

    def labels_of(self, clip: int) -> tuple[str, str]:
        """Person and task of the real clip with this index."""
        cell = self.member[clip]
        return self.persons[self.person[cell]], self.tasks[self.task[cell]]

    def clips_of(self, person: str | None = None, task: str | None = None) -> IntArray:
        """Indices of the real clips of a person, of a task, or of both."""
        cells = np.ones(len(self.person), dtype=bool)
        if person is not None:
            cells &= self.person == self._of(person, self.persons)
        if task is not None:
            cells &= self.did(task)
        return np.flatnonzero(cells[self.member])

    def did(self, task: str) -> BoolArray:
        """(cells,) which are of a task."""
        return np.asarray(self.task == self._of(task, self.tasks))

    @staticmethod
    def _of(name: str, names: tuple[str, ...]) -> int:
        return names.index(name) if name in names else -2

    def to_arrays(self) -> tuple[dict[str, np.ndarray[Any, Any]], dict[str, Any]]:
        """Arrays and JSON-able meta from which from_arrays makes the same record."""
        arrays = {
            "means": self.means.astype(np.float32),
            "person": self.person,
            "task": self.task,
            "takes": self.takes,
            "agreement": self.agreement,
            "side": self.side,
            "aligned": self.aligned.astype(np.float32),
            "timing": self.timing.astype(np.float32),
            "centre": self.axes.centre,
            "axes": self.axes.axes,
            "points": self.points.astype(np.float32),
            "member": self.member,
        }
        meta = {
            "version": SYNTHESIS_VERSION,
            "persons": list(self.persons),
            "tasks": list(self.tasks),
            "ids": list(self.ids),
        }
        return arrays, meta

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, Any], meta: Mapping[str, Any]) -> Synthesis:
        """The record that to_arrays took apart. Raises ValueError on another version."""
        if meta["version"] != SYNTHESIS_VERSION:
            raise ValueError(f"synthesis model of version {meta['version']}")
        return cls(
            tuple(meta["persons"]),
            tuple(meta["tasks"]),
            arrays["means"].astype(np.float64),
            arrays["person"],
            arrays["task"],
            arrays["takes"],
            arrays["agreement"],
            arrays["side"],
            arrays["aligned"].astype(np.float64),
            arrays["timing"].astype(np.float64),
            PrincipalAxes(arrays["centre"], arrays["axes"]),
            arrays["points"].astype(np.float64),
            tuple(meta["ids"]),
            arrays["member"],
        )


def fit_synthesis(
    shapes: FloatArray,
    persons: Sequence[str | None],
    tasks: Sequence[str | None],
    ids: Sequence[str] | None = None,
) -> Synthesis:
    """Fit on motion shapes (clips, 1378) that have both labels; others are left out.

    ids: (clips,) by default their numbers. Of takes of one cell that are partly cyclic the
    more frequent kind is kept. Raises NotEnoughLabels without two persons and two tasks, where
    no two persons did the same, and with too many cells.
    """
    use = [i for i, labels in enumerate(zip(persons, tasks, strict=True)) if all(labels)]
    names = [str(i) if ids is None else ids[i] for i in use]
    rows = np.asarray(shapes, dtype=np.float64)[use].reshape(len(use), SHAPE_LENGTH)
    cells = find_cells([persons[i] for i in use], [tasks[i] for i in use])
    _check(cells)
    means, agreed = _cell_means(rows, cells)
    side = _sides(means, cells)
    timed = together(to_side(means, side, 1), cells.task)
    counted = rows * weights()
    axes = principal_axes(counted, DIMENSIONS)
    return Synthesis(
        cells.persons,
        cells.tasks,
        means,
        cells.person,
        cells.task,
        cells.takes,
        agreed,
        side,
        timed.shapes,
        timed.timing,
        axes,
        axes.project(counted),
        tuple(names),
        cells.member,
    )


def _cell_means(rows: FloatArray, cells: Cells) -> tuple[FloatArray, FloatArray]:
    """(cells, 1378) the mean of the takes of each, or the one most like the others where they do
    not agree; and (cells,) how far they do."""
    kept = _of_one_kind(rows, cells)
    member, rows = cells.member[kept], rows[kept]
    order = np.argsort(member, kind="stable")
    takes = np.split(order, np.cumsum(np.bincount(member))[:-1])
    turned = np.array(rows)
    for of_cell in takes:
        turned[of_cell] = to_side(rows[of_cell], sides(rows[of_cell]), 1)
    timed = together(turned, member).shapes
    means, agreed = np.empty((len(cells), SHAPE_LENGTH)), np.empty(len(cells))
    for cell, of_cell in enumerate(takes):
        agreed[cell] = agreement(timed[of_cell])
        if agree(agreed[cell]):
            means[cell] = timed[of_cell].mean(axis=0)
        else:
            means[cell] = rows[of_cell[medoid(timed[of_cell] * weights())]]
    return means, agreed


def _sides(means: FloatArray, cells: Cells) -> IntArray:
    """(cells,) to which side each task is done, held against the task's other cells alone."""
    found = np.zeros(len(cells), dtype=np.int64)
    for task in range(len(cells.tasks)):
        of_task = np.flatnonzero(cells.task == task)
        found[of_task] = sides(means[of_task])
    return found


def mean_of_takes(shapes: FloatArray) -> FloatArray:
    """(1378,) what a cell's takes, motion shapes (n, 1378), n > 0, come to."""
    names = ["all"] * len(shapes)
    rows = np.asarray(shapes, dtype=np.float64)
    return np.asarray(_cell_means(rows, find_cells(names, names))[0][0])


def _check(cells: Cells) -> None:
    if min(len(cells.persons), len(cells.tasks)) < 2:
        raise NotEnoughLabels("Synthesis needs clips of two persons and of two tasks.")
    if np.bincount(cells.task).max() < 2:
        raise NotEnoughLabels("Synthesis needs a task that two persons did.")
    if len(cells) > MAX_CELLS:
        raise NotEnoughLabels(f"Synthesis holds {MAX_CELLS} combinations of person and task.")


def _of_one_kind(rows: FloatArray, cells: Cells) -> IntArray:
    """The clips that are cyclic as most of their cell are; a mean of both would be neither."""
    is_cyclic = rows[:, -1] >= 0.5
    share = np.bincount(cells.member, weights=is_cyclic, minlength=len(cells)) / cells.takes
    return np.flatnonzero(is_cyclic == (share >= 0.5)[cells.member])
