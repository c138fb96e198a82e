"""The model of synthesis: the mean motion shape of each person at each task.

Before the mean, takes are mirrored to one side (app.models.synthesis.sides) and warped to a common
time (app.models.synthesis.timing). If the takes do not agree (app.models.synthesis.agreement), the
take that is most like the others replaces the mean.

From these means, app.models.synthesis.prediction predicts the motion of a person at a task that
they never recorded (Vasilescu 2002, section 4): a new task for known persons, or any known task
for a person with only a few clips. Solving eq. 7 for a signature among few persons was much less
accurate. After these choices, all steps are linear and deterministic.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from app.analysis.descriptors.motion_shape import SHAPE_LENGTH
from app.errors import NotEnoughLabels
from app.models.cells import Cells, even_takes, find_cells
from app.models.synthesis.agreement import agree, agreement
from app.models.synthesis.basis import weights
from app.models.synthesis.sides import sides, to_side
from app.models.synthesis.timing import medoid, warp_to_groups
from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.numerics.principal_axes import PrincipalAxes, principal_axes

SYNTHESIS_VERSION = 2

DIMENSIONS = 64
"""Number of coordinates in which real clips are compared with synthesized motions."""

MAX_TAKES = 2000
"""The largest number of takes whose means are computed: of more, evenly chosen takes of each cell.
All takes stay in the model as clips to compare with."""

MAX_CELLS = 20_000
"""Largest number of cells; they take about 220 MB."""


@dataclass(frozen=True, slots=True)
class Synthesis:
    """A fitted model.

    persons, tasks: sorted labels; means: (cells, 1378) mean motion shapes; person, task:
    (cells,) label indices; takes: (cells,) number of clips; agreement: (cells,) agreement of the
    takes; below MIN_AGREEMENT the "mean" is one of the takes.

    side: (cells,) side of each task, +1 or -1, 0 for a task without sides; aligned: (cells,
    1378) the means mirrored to the side +1 and in the time of the task; timing: (cells, 32), see
    `Timed`.

    axes, points (N, 64), ids (N,), member (N,): coordinates, ids and cells of the N real clips,
    for finding the real clip that is nearest to a synthesized one.
    """

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
        """(1378,) the mean of a person's takes of a task, None if there is none."""
        is_cell = (self._of(person, self.persons) == self.person) & self.did(task)
        cells = np.flatnonzero(is_cell)
        return np.asarray(self.means[cells[0]]) if len(cells) else None

    def cell_agreement(self, person: str, task: str) -> float | None:
        """The agreement of a person's takes of a task, None if there are fewer than two."""
        is_cell = (self._of(person, self.persons) == self.person) & self.did(task)
        cells = np.flatnonzero(is_cell & (self.takes > 1))
        return float(self.agreement[cells[0]]) if len(cells) else None

    def reference(self, task: str) -> FloatArray:
        """(1378,) the mean of all persons' aligned shapes of a task."""
        return np.asarray(self.aligned[self.did(task)].mean(axis=0))

    def is_two_sided(self, task: str) -> bool:
        """Whether the persons do a task to two sides (such as left and right)."""
        return bool(self.side[self.did(task)].any())

    def tasks_of(self, person: str) -> dict[str, FloatArray]:
        """Mean shapes (1378,) of a person by task."""
        cells = np.flatnonzero(self.person == self._of(person, self.persons))
        return {self.tasks[self.task[cell]]: self.means[cell] for cell in cells}

    def who_did(self, task: str) -> tuple[str, ...]:
        """The persons who did a task."""
        return tuple(self.persons[i] for i in sorted(self.person[self.did(task)]))

    def distances(self, shape: FloatArray) -> FloatArray:
        """(N,) distances of the real clips from a motion shape (1378,)."""
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
        """(cells,) whether each cell has this task."""
        return np.asarray(self.task == self._of(task, self.tasks))

    @staticmethod
    def _of(name: str, names: tuple[str, ...]) -> int:
        # -2 differs from every label index, also from -1, which is a missing label
        return names.index(name) if name in names else -2

    def to_arrays(self) -> tuple[dict[str, np.ndarray[Any, Any]], dict[str, Any]]:
        """Arrays and JSON-able metadata for `from_arrays`."""
        arrays = {
            "means": self.means.astype(np.float32),
            "person": self.person,
            "task": self.task,
            "takes": self.takes,
            "agreement": self.agreement,
            "side": self.side,
            "aligned": self.aligned.astype(np.float32),
            "timing": self.timing.astype(np.float32),
            "centre": self.axes.center,
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
        """The model from the result of `to_arrays`. Raises ValueError on another version."""
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

    ids: (clips,) by default their numbers. If some takes of a cell are cyclic and others are not,
    only the more frequent kind is used. Raises NotEnoughLabels with fewer than two persons or two
    tasks, if no task was done by two persons, and with more than MAX_CELLS cells.
    """
    use = [i for i, labels in enumerate(zip(persons, tasks, strict=True)) if all(labels)]
    names = [str(i) if ids is None else ids[i] for i in use]
    rows = np.asarray(shapes, dtype=np.float64)[use].reshape(len(use), SHAPE_LENGTH)
    cells = find_cells([persons[i] for i in use], [tasks[i] for i in use])
    _check(cells)
    means, agreed = _cell_means(rows, cells)
    side = _sides(means, cells)
    timed = warp_to_groups(to_side(means, side, 1), cells.task)
    weighted = rows * weights()
    axes = principal_axes(weighted, DIMENSIONS)
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
        axes.project(weighted),
        tuple(names),
        cells.member,
    )


def _cell_means(rows: FloatArray, cells: Cells) -> tuple[FloatArray, FloatArray]:
    """(cells, 1378) the mean of the takes of each cell (or, if they do not agree, the take that is
    most like the others), and (cells,) their agreement."""
    used = _of_one_kind(rows, cells)
    own = cells.member[used]
    of_one_kind = replace(cells, member=own, takes=np.bincount(own))
    used = used[even_takes(of_one_kind, MAX_TAKES)]
    member, rows = cells.member[used], rows[used]
    order = np.argsort(member, kind="stable")
    takes = np.split(order, np.cumsum(np.bincount(member))[:-1])
    one_side = np.array(rows)
    for of_cell in takes:
        one_side[of_cell] = to_side(rows[of_cell], sides(rows[of_cell]), 1)
    timed = warp_to_groups(one_side, member).shapes
    means, agreed = np.empty((len(cells), SHAPE_LENGTH)), np.empty(len(cells))
    for cell, of_cell in enumerate(takes):
        agreed[cell] = agreement(timed[of_cell])
        if agree(agreed[cell]):
            means[cell] = timed[of_cell].mean(axis=0)
        else:
            means[cell] = rows[of_cell[medoid(timed[of_cell] * weights())]]
    return means, agreed


def _sides(means: FloatArray, cells: Cells) -> IntArray:
    """(cells,) the side of each cell, by comparison with the other cells of its task."""
    side = np.zeros(len(cells), dtype=np.int64)
    for task in range(len(cells.tasks)):
        of_task = np.flatnonzero(cells.task == task)
        side[of_task] = sides(means[of_task])
    return side


def mean_of_takes(shapes: FloatArray) -> FloatArray:
    """(1378,) the mean of a cell's takes (n, 1378), n > 0, as in `Synthesis.means`."""
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
    """Indices of the clips that are of the kind (cyclic or not) of most clips of their cell."""
    is_cyclic = rows[:, -1] >= 0.5
    share = np.bincount(cells.member, weights=is_cyclic, minlength=len(cells)) / cells.takes
    return np.flatnonzero(is_cyclic == (share >= 0.5)[cells.member])
