"""A person's motion for a task that they never recorded (Vasilescu 2002, section 4).

The cells of persons and tasks hold mean motion shapes. The parameters of the wanted task are
found as in eq. 8, jointly over all persons who did it (least squares, not a mean of inverses):
the weights w with which the tasks that the asked person did make it of these persons' motions.
The same w makes it of the person's own. So a new task comes to known persons, and every known
task to a person of whom there are only some clips; where few tasks are known this was far
nearer to the truth than solving eq. 7 for a signature among few persons
(tests/bench/test_synthesis.py). Beyond the paper, each of which raised the held-out hits:
- what w leaves over of these persons' motions is carried over as their mean ("residual");
- the parts of the body have weights of their own, drawn towards those of the whole;
- a mirrored task is a task: raising the left hand tells how one raises the right.
Missing cells are completed by person and task effects. All is linear and deterministic.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.analysis.motion_shape import SHAPE_LENGTH, mirrored
from app.errors import NotEnoughLabels
from app.models.cells import Cells, cell_means, find_cells, fit_effects
from app.models.synthesis_basis import parts, weights
from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.numerics.principal_axes import PrincipalAxes, principal_axes

SYNTHESIS_VERSION = 1

WHOLE_RIDGE = 0.01
"""Pull of the weights of the whole towards the mean of the tasks, in mean squares of a task."""

PART_RIDGE = 0.02
"""Pull of a part's weights towards those of the whole, likewise."""

MOST_TASKS = 24
"""Tasks of which one is made: the most alike; more only cost time."""

TEMPO_SLACK = 0.15
"""Of log seconds: nobody is made to be much quicker or slower at a task than all who did it."""

MOST_PERSONS = 64
"""Persons of whose motions one is made: those who did most of the same tasks."""

DIMENSIONS = 64
"""Coordinates in which real clips are compared with what was made."""

MOST_CELLS = 20_000
"""Cells that are kept: some 110 MB."""


@dataclass(frozen=True, slots=True)
class Synthesis:
    """persons, tasks: sorted labels; means: (cells, 1378) mean motion shapes; person, task:
    (cells,) index of the label; takes: (cells,) clips of each. axes, points (N, 64), ids (N,),
    member (N,): the real clips' weighted shapes, among which the nearest to a made one is
    looked up, and the cell of each."""

    persons: tuple[str, ...]
    tasks: tuple[str, ...]
    means: FloatArray
    person: IntArray
    task: IntArray
    takes: IntArray
    axes: PrincipalAxes
    points: FloatArray
    ids: tuple[str, ...]
    member: IntArray

    def cell(self, person: str, task: str) -> FloatArray | None:
        """(1378,) the mean of a person's own takes of a task, None where there is none."""
        found = np.flatnonzero((self._of(person, self.persons) == self.person) & self._did(task))
        return np.asarray(self.means[found[0]]) if len(found) else None

    def tasks_of(self, person: str) -> dict[str, FloatArray]:
        """Mean shapes (1378,) of what a person did, by task."""
        cells = np.flatnonzero(self.person == self._of(person, self.persons))
        return {self.tasks[self.task[cell]]: self.means[cell] for cell in cells}

    def who_did(self, task: str) -> tuple[str, ...]:
        """The persons who did a task."""
        return tuple(self.persons[i] for i in sorted(self.person[self._did(task)]))

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
            cells &= self._did(task)
        return np.flatnonzero(cells[self.member])

    def _did(self, task: str) -> BoolArray:
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
    kept = _of_one_kind(rows, cells)
    means = cell_means(rows[kept], find_cells(*_labels(cells, kept)))
    counted = rows * weights()
    axes = principal_axes(counted, DIMENSIONS)
    return Synthesis(
        cells.persons,
        cells.tasks,
        means,
        cells.person,
        cells.task,
        cells.takes,
        axes,
        axes.project(counted),
        tuple(names),
        cells.member,
    )


def predict(
    record: Synthesis, given: Mapping[str, FloatArray], task: str, but: Sequence[str] = ()
) -> FloatArray:
    """(1378,) the motion shape of `task` for someone whose shapes of other tasks are `given`.

    but: persons who are not to be learned from, as the asked one. Raises NotEnoughLabels where
    nobody else did the task, or nothing that the asked person did.
    """
    told = {name: shape for name, shape in given.items() if name in record.tasks and name != task}
    others = [name for name in record.who_did(task) if name not in but]
    if not told:
        raise NotEnoughLabels(
            "A clip of another task of the library is needed of the person asked for."
        )
    if not others:
        raise NotEnoughLabels(f"Nobody else did the task {task}: a clip of another person's.")
    chosen = _most_alike(record, told, task)
    own = np.stack([told[name] for name in chosen]).astype(np.float64)
    known = _known_tensor(record, _who_shares_most(record, others, chosen), [*chosen, task], own)
    basis, wanted = known[:, :-1], known[:, -1]
    shape = solve(basis, wanted, own)
    shape[-1] = float(np.mean(wanted[:, -1]) >= 0.5)
    shortest, longest = wanted[:, -2].min(), wanted[:, -2].max()
    shape[-2] = np.clip(shape[-2], shortest - TEMPO_SLACK, longest + TEMPO_SLACK)
    return shape


def solve(basis: FloatArray, wanted: FloatArray, own: FloatArray) -> FloatArray:
    """(1378,) from what K persons did and the wanted task by each, (K, T, 1378), (K, 1378), and
    what the asked person did, (T, 1378): eq. 8 jointly, and the residual carried over."""
    scale, tasks = weights(), basis.shape[1]
    both = np.concatenate([basis, _mirrored(basis)], axis=1) * scale  # (K, 2T, d)
    asked = np.concatenate([own, mirrored(own)]) * scale  # (2T, d)
    target = wanted * scale
    prior = np.concatenate([np.full(tasks, 1 / tasks), np.zeros(tasks)])
    by_part = [(part, *_normal(both[:, :, part], target[:, part])) for part in parts()]
    gram = np.sum([one for _, one, _ in by_part], axis=0)
    aim = np.sum([one for _, _, one in by_part], axis=0)
    shared = _ridge(gram, aim, prior, WHOLE_RIDGE)
    shape = np.empty(SHAPE_LENGTH)
    for part, gram, aim in by_part:
        w = _ridge(gram, aim, shared, PART_RIDGE)
        residual = target[:, part] - np.matmul(w, both[:, :, part])
        shape[part] = w @ asked[:, part] + residual.mean(axis=0)
    return shape / scale


def effects_only(basis: FloatArray, wanted: FloatArray, own: FloatArray) -> FloatArray:
    """As `solve`, by person and task effects added up: a baseline."""
    return np.asarray(own.mean(axis=0) + (wanted - basis.mean(axis=1)).mean(axis=0))


def _normal(basis: FloatArray, target: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(2T, 2T) and (2T,): the normal equations of all persons together."""
    rows = basis.transpose(1, 0, 2).reshape(basis.shape[1], -1)  # (2T, K d)
    return rows @ rows.T, rows @ target.ravel()


def _ridge(gram: FloatArray, aim: FloatArray, prior: FloatArray, ridge: float) -> FloatArray:
    """(2T,) weights nearest to the aim, drawn towards `prior`."""
    size = len(gram)
    pull = ridge * float(np.trace(gram)) / size + 1e-12
    return np.asarray(prior + np.linalg.solve(gram + pull * np.eye(size), aim - gram @ prior))


def _mirrored(basis: FloatArray) -> FloatArray:
    return mirrored(basis.reshape(-1, SHAPE_LENGTH)).reshape(basis.shape)


def _most_alike(record: Synthesis, told: Mapping[str, FloatArray], task: str) -> list[str]:
    """The told tasks that are most like the wanted one, themselves or mirrored."""
    if len(told) <= MOST_TASKS:
        return list(told)
    scale, aim = weights(), record.means[record._did(task)].mean(axis=0)
    means = np.stack([record.means[record._did(name)].mean(axis=0) for name in told])
    away = [np.linalg.norm((rows - aim) * scale, axis=1) for rows in (means, mirrored(means))]
    near = np.argsort(np.min(away, axis=0), kind="stable")[:MOST_TASKS]
    names = list(told)
    return [names[i] for i in np.sort(near)]


def _who_shares_most(record: Synthesis, persons: list[str], tasks: list[str]) -> list[str]:
    """The persons who did most of these tasks: of them there is least to be completed."""
    if len(persons) <= MOST_PERSONS:
        return persons
    wanted = np.isin(record.task, [record.tasks.index(name) for name in tasks])
    shared = np.bincount(record.person[wanted], minlength=len(record.persons))
    count = [shared[record.persons.index(name)] for name in persons]
    return [persons[i] for i in np.sort(np.argsort(-np.array(count), kind="stable")[:MOST_PERSONS])]


def _known_tensor(
    record: Synthesis, persons: list[str], tasks: list[str], own: FloatArray
) -> FloatArray:
    """(persons, tasks, 1378); missing cells by person and task effects.

    own: (tasks - 1, 1378) what the asked person did, which tells of the effects too.
    """
    person, task = _places(record.persons, persons), _places(record.tasks, tasks)
    kept = np.flatnonzero((person[record.person] >= 0) & (task[record.task] >= 0))
    rows, columns = person[record.person[kept]], task[record.task[kept]]
    known = np.full((len(persons), len(tasks), SHAPE_LENGTH), np.nan)
    known[rows, columns] = record.means[kept]
    missing = np.isnan(known[:, :, 0])
    if missing.any():
        asked = np.arange(len(own))
        rows = np.concatenate([rows, np.full(len(own), len(persons))])
        means, count = np.concatenate([record.means[kept], own]), len(kept) + len(own)
        cells = Cells(
            (*persons, ""),
            tuple(tasks),
            np.arange(count),
            rows,
            np.concatenate([columns, asked]),
            np.ones(count, dtype=np.int64),
        )
        known[missing] = fit_effects(means, cells).predict(*np.nonzero(missing))
    return known


def _places(names: tuple[str, ...], chosen: list[str]) -> IntArray:
    """(names,) where each stands among the chosen, -1 where it does not."""
    found = np.full(len(names), -1)
    found[[names.index(name) for name in chosen]] = np.arange(len(chosen))
    return found


def _check(cells: Cells) -> None:
    if min(len(cells.persons), len(cells.tasks)) < 2:
        raise NotEnoughLabels("Synthesis needs clips of two persons and of two tasks.")
    if np.bincount(cells.task).max() < 2:
        raise NotEnoughLabels("Synthesis needs a task that two persons did.")
    if len(cells) > MOST_CELLS:
        raise NotEnoughLabels(f"Synthesis holds {MOST_CELLS} combinations of person and task.")


def _of_one_kind(rows: FloatArray, cells: Cells) -> IntArray:
    """The clips that are cyclic as most of their cell are; a mean of both would be neither."""
    is_cyclic = rows[:, -1] >= 0.5
    share = np.bincount(cells.member, weights=is_cyclic, minlength=len(cells)) / cells.takes
    return np.flatnonzero(is_cyclic == (share >= 0.5)[cells.member])


def _labels(cells: Cells, kept: IntArray) -> tuple[list[str], list[str]]:
    member = cells.member[kept]
    return (
        [cells.persons[i] for i in cells.person[member]],
        [cells.tasks[i] for i in cells.task[member]],
    )
