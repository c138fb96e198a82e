"""Collects the cells for a prediction, and aligns their sides and times so that they can be added.

A prediction is for one person, the target person, at one task, the target task. The motions of the
target person are never mirrored. The motions of the other persons are mirrored to the sides of the
target person. Missing cells are predicted from person and task effects.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from app.analysis.descriptors.motion_sample import SAMPLES
from app.analysis.descriptors.motion_shape import SHAPE_LENGTH, mirrored
from app.models.cells import Cells, fit_effects
from app.models.synthesis.agreement import agreement
from app.models.synthesis.basis import weights
from app.models.synthesis.model import Synthesis
from app.models.synthesis.sides import likely_side, sides, to_side
from app.models.synthesis.timing import Timed, medoid, warp_to_groups, warp_to_references
from app.numerics.arrays import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class OwnMotions:
    """The motions of the target person.

    tasks: (T,) names; side: (T,) the person's side of each, 0 for a task without sides; timed:
    the shapes in the time of their tasks.
    """

    tasks: tuple[str, ...]
    side: IntArray
    timed: Timed


@dataclass(frozen=True, slots=True)
class TargetMotions:
    """The target task by K other persons.

    timed: their shapes, mirrored to the likely side of the target person; agreement: between the
    persons, or between the takes of a single person, None for a single take; most_typical: the
    index of the person whose shape is nearest to all others.
    """

    timed: Timed
    agreement: float | None
    most_typical: int


@dataclass(frozen=True, slots=True)
class BasisTensor:
    """The tasks of the target person by K other persons.

    basis: (K, T, 1378) the shapes of the T tasks; timing: (K, T, 32) their timing, see `Timed`.
    """

    basis: FloatArray
    timing: FloatArray


def own_motions(record: Synthesis, given: Mapping[str, FloatArray]) -> OwnMotions:
    """The motions of the target person, from shapes (1378,) by task.

    They are aligned at the side +1, which is the side of the references, and mirrored back then.
    """
    tasks = tuple(given)
    shapes = np.stack([given[name] for name in tasks]).astype(np.float64)
    references = np.stack([record.reference(name) for name in tasks])
    side = np.array(
        [
            _nearer_side(shape, reference) if record.is_two_sided(name) else 0
            for name, shape, reference in zip(tasks, shapes, references, strict=True)
        ]
    )
    timed = warp_to_references(to_side(shapes, side, 1), references)
    mirrored_back = to_side(timed.shapes, np.ones_like(side), side)
    return OwnMotions(tasks, side, Timed(mirrored_back, timed.timing))


def target_motions(
    record: Synthesis, task: str, persons: list[str], own: OwnMotions
) -> TargetMotions:
    """The target task by `persons`; sides and time are computed from these persons only."""
    cells = [record.cell(name, task) for name in persons]
    shapes = np.stack([cell for cell in cells if cell is not None])
    side = sides(shapes)
    target_side = likely_side(own.side.tolist(), _sides_of(record, persons, own.tasks), side)
    timed = warp_to_groups(
        to_side(shapes, side, target_side), np.zeros(len(shapes), dtype=np.int64)
    )
    # Cyclic and other shapes cannot be compared: only the more frequent kind is.
    is_usual = (shapes[:, -1] >= 0.5) == (np.mean(shapes[:, -1]) >= 0.5)
    usual = np.flatnonzero(is_usual)
    rows = timed.shapes[usual]
    is_single = len(persons) == 1
    agreed = record.cell_agreement(persons[0], task) if is_single else agreement(rows)
    return TargetMotions(timed, agreed, int(usual[medoid(rows * weights())]))


def basis_tensor(
    record: Synthesis, persons: list[str], own: OwnMotions, target: Timed
) -> BasisTensor:
    """The target person's tasks by `persons` (K).

    target: (K, ...) the target task by the same persons; it helps to predict missing cells.
    """
    person, task = _index_in(record.persons, persons), _index_in(record.tasks, list(own.tasks))
    used = np.flatnonzero((person[record.person] >= 0) & (task[record.task] >= 0))
    rows, columns = person[record.person[used]], task[record.task[used]]
    # (K, T, 1378 + 32) shape and timing of each cell side by side; NaN marks a missing cell
    cells = np.full((len(persons), len(own.tasks), SHAPE_LENGTH + SAMPLES), np.nan)
    shapes = to_side(record.aligned[used], np.ones_like(used), own.side[columns])
    cells[rows, columns] = np.hstack([shapes, record.timing[used]])
    missing = np.isnan(cells[:, :, 0])
    if missing.any():
        cells[missing] = _predicted_cells(cells, own, target)
    return BasisTensor(cells[..., :SHAPE_LENGTH], cells[..., SHAPE_LENGTH:])


def _predicted_cells(known: FloatArray, own: OwnMotions, target: Timed) -> FloatArray:
    """(missing, 1410) the missing cells of `known` (K, T, 1410), by person and task effects.

    The target person is one more person, after the K others. The target task is one more task,
    after the T tasks. Their cells take part in the fit.
    """
    persons, tasks = known.shape[:2]
    missing = np.isnan(known[:, :, 0])
    rows, columns = np.nonzero(~missing)
    of_target_person = np.hstack([own.timed.shapes, own.timed.timing])
    of_target_task = np.hstack([target.shapes, target.timing])
    cells = Cells(
        tuple(str(i) for i in range(persons + 1)),
        tuple(str(i) for i in range(tasks + 1)),
        np.arange(len(rows) + tasks + persons),
        np.concatenate([rows, np.full(tasks, persons), np.arange(persons)]),
        np.concatenate([columns, np.arange(tasks), np.full(persons, tasks)]),
        np.ones(len(rows) + tasks + persons, dtype=np.int64),
    )
    means = np.concatenate([known[rows, columns], of_target_person, of_target_task])
    effects = fit_effects(means, cells)
    return effects.predict(*np.nonzero(missing))


def _nearer_side(shape: FloatArray, reference: FloatArray) -> int:
    """The side of a shape (1378,) of a task with two sides; reference: a shape of the side +1."""
    both = np.stack([shape, mirrored(shape[None])[0]])
    away = np.linalg.norm((both - reference) * weights(), axis=1)
    return 1 if away[0] <= away[1] else -1


def _sides_of(record: Synthesis, persons: list[str], tasks: tuple[str, ...]) -> list[IntArray]:
    """For each task, the sides (K,) of the persons; 0 if a person has no clip of it."""
    side = np.zeros((len(tasks), len(persons)), dtype=np.int64)
    person, task = _index_in(record.persons, persons), _index_in(record.tasks, list(tasks))
    used = np.flatnonzero((person[record.person] >= 0) & (task[record.task] >= 0))
    side[task[record.task[used]], person[record.person[used]]] = record.side[used]
    return list(side)


def _index_in(names: tuple[str, ...], chosen: list[str]) -> IntArray:
    """(names,) the index of each of `names` in `chosen`, -1 for a name that was not chosen."""
    index = np.full(len(names), -1)
    index[[names.index(name) for name in chosen]] = np.arange(len(chosen))
    return index
