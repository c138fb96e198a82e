"""What someone is expected to do who did something else: from the cells of a library to the
solver's tensors and back. Missing cells are completed by person and task effects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from app.analysis.motion_sample import SAMPLES
from app.analysis.motion_shape import CHANNELS, SHAPE_LENGTH, clearance, mirrored
from app.errors import NotEnoughLabels
from app.models.cells import Cells, fit_effects
from app.models.synthesis import Synthesis
from app.models.synthesis_basis import weights
from app.models.synthesis_solving import solve
from app.numerics.arrays import FloatArray, IntArray

MOST_TASKS = 24
"""Tasks of which one is made: the most alike; more only cost time."""

MOST_PERSONS = 64
"""Persons of whose motions one is made: those who did most of the same tasks."""

TEMPO_SLACK = 0.15
"""Of log seconds: nobody is made to be much quicker or slower at a task than all who did it."""


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
    return _off_the_floor(shape, wanted)


def _off_the_floor(shape: FloatArray, wanted: FloatArray) -> FloatArray:
    """The shape (1378,) as high over the floor as somebody is who does the task (K, 1378).

    Legs and hips have weights of their own: bent knees would leave the feet in the air.
    """
    moments = shape[:-2].reshape(SAMPLES, CHANNELS)
    there = clearance(wanted[:, :-2].reshape(-1, SAMPLES, CHANNELS))
    now = clearance(moments)
    moments[:, 39] += np.clip(now, there.min(axis=0), there.max(axis=0)) - now
    return np.concatenate([moments.ravel(), shape[-2:]])


def _most_alike(record: Synthesis, told: Mapping[str, FloatArray], task: str) -> list[str]:
    """The told tasks that are most like the wanted one, themselves or mirrored."""
    if len(told) <= MOST_TASKS:
        return list(told)
    scale, aim = weights(), record.means[record.did(task)].mean(axis=0)
    means = np.stack([record.means[record.did(name)].mean(axis=0) for name in told])
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
