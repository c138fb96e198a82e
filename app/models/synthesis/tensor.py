"""Collects the cells for a prediction, and aligns their sides and times so that they can be added.

The motions of the asked person are never mirrored. Those of the others are mirrored to the sides of
the asked person. Missing cells are completed by person and task effects.
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
    """The motions of the asked person.

    tasks: (T,) names; side: (T,) the person's side of each, 0 for a task without sides; timed:
    the shapes in the time of their tasks.
    """

    tasks: tuple[str, ...]
    side: IntArray
    timed: Timed


@dataclass(frozen=True, slots=True)
class TargetMotions:
    """The wanted task by K other persons.

    timed: their shapes, mirrored to the likely side of the asked person; agreement: their
    agreement, for a single person that of their takes, None for a single take; most_like_all:
    index of the person who is most like the others.
    """

    timed: Timed
    agreement: float | None
    most_like_all: int


@dataclass(frozen=True, slots=True)
class BasisTensor:
    """basis: (K, T, 1378) shapes of T tasks by K other persons; timing: (K, T, 32)."""

    basis: FloatArray
    timing: FloatArray


def own_motions(record: Synthesis, given: Mapping[str, FloatArray]) -> OwnMotions:
    """The motions of the asked person, from shapes (1378,) by task."""
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
    as_they_do = to_side(timed.shapes, np.ones_like(side), side)
    return OwnMotions(tasks, side, Timed(as_they_do, timed.timing))


def target_motions(
    record: Synthesis, task: str, persons: list[str], own: OwnMotions
) -> TargetMotions:
    """The wanted task by `persons`; sides and time are computed from these persons only."""
    cells = [record.cell(name, task) for name in persons]
    shapes = np.stack([cell for cell in cells if cell is not None])
    side = sides(shapes)
    asked = likely_side(own.side.tolist(), _sides_of(record, persons, own.tasks), side)
    timed = warp_to_groups(to_side(shapes, side, asked), np.zeros(len(shapes), dtype=np.int64))
    usual = (shapes[:, -1] >= 0.5) == (np.mean(shapes[:, -1]) >= 0.5)
    of_kind = np.flatnonzero(usual)
    rows = timed.shapes[of_kind]
    alone = len(persons) == 1
    agreed = record.cell_agreement(persons[0], task) if alone else agreement(rows)
    return TargetMotions(timed, agreed, int(of_kind[medoid(rows * weights())]))


def basis_tensor(
    record: Synthesis, persons: list[str], own: OwnMotions, wanted: Timed
) -> BasisTensor:
    """The asked person's tasks by `persons` (K).

    wanted: (K, ...) the wanted task by them; it helps to complete missing cells.
    """
    person, task = _places(record.persons, persons), _places(record.tasks, list(own.tasks))
    kept = np.flatnonzero((person[record.person] >= 0) & (task[record.task] >= 0))
    rows, columns = person[record.person[kept]], task[record.task[kept]]
    known = np.full((len(persons), len(own.tasks), SHAPE_LENGTH + SAMPLES), np.nan)
    shapes = to_side(record.aligned[kept], np.ones_like(kept), own.side[columns])
    known[rows, columns] = np.hstack([shapes, record.timing[kept]])
    missing = np.isnan(known[:, :, 0])
    if missing.any():
        known[missing] = _completed(known, own, wanted)
    return BasisTensor(known[..., :SHAPE_LENGTH], known[..., SHAPE_LENGTH:])


def _completed(known: FloatArray, own: OwnMotions, wanted: Timed) -> FloatArray:
    """(missing, ...) the missing cells of `known`, predicted by person and task effects."""
    persons, tasks = known.shape[:2]
    missing = np.isnan(known[:, :, 0])
    rows, columns = np.nonzero(~missing)
    asked = np.hstack([own.timed.shapes, own.timed.timing])
    others = np.hstack([wanted.shapes, wanted.timing])
    cells = Cells(
        tuple(str(i) for i in range(persons + 1)),
        tuple(str(i) for i in range(tasks + 1)),
        np.arange(len(rows) + tasks + persons),
        np.concatenate([rows, np.full(tasks, persons), np.arange(persons)]),
        np.concatenate([columns, np.arange(tasks), np.full(persons, tasks)]),
        np.ones(len(rows) + tasks + persons, dtype=np.int64),
    )
    effects = fit_effects(np.concatenate([known[rows, columns], asked, others]), cells)
    return effects.predict(*np.nonzero(missing))


def _nearer_side(shape: FloatArray, reference: FloatArray) -> int:
    """The side of a shape (1378,) of a task with two sides; reference: a shape of the side +1."""
    both = np.stack([shape, mirrored(shape[None])[0]])
    away = np.linalg.norm((both - reference) * weights(), axis=1)
    return 1 if away[0] <= away[1] else -1


def _sides_of(record: Synthesis, persons: list[str], tasks: tuple[str, ...]) -> list[IntArray]:
    """For each task, the sides (K,) of the persons; 0 if a person did not do it."""
    found = np.zeros((len(tasks), len(persons)), dtype=np.int64)
    person, task = _places(record.persons, persons), _places(record.tasks, list(tasks))
    kept = np.flatnonzero((person[record.person] >= 0) & (task[record.task] >= 0))
    found[task[record.task[kept]], person[record.person[kept]]] = record.side[kept]
    return list(found)


def _places(names: tuple[str, ...], chosen: list[str]) -> IntArray:
    """(names,) the index of each name in `chosen`, -1 if it is not there."""
    found = np.full(len(names), -1)
    found[[names.index(name) for name in chosen]] = np.arange(len(chosen))
    return found
