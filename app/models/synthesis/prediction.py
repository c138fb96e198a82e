"""Predicts the motion of a person at a task from their motions at other tasks.

It collects the tensors for the solver (app.models.synthesis.tensor) and brings the solution back to
its own time.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from app.analysis.descriptors.motion_sample import SAMPLES
from app.analysis.descriptors.motion_shape import CHANNELS, clearance, mirrored
from app.errors import NotEnoughLabels
from app.models.synthesis.agreement import agree
from app.models.synthesis.basis import weights
from app.models.synthesis.model import Synthesis
from app.models.synthesis.solving import follow, solve
from app.models.synthesis.tensor import (
    BasisTensor,
    TargetMotions,
    basis_tensor,
    own_motions,
    target_motions,
)
from app.models.synthesis.timing import Timed, to_own_time
from app.numerics.arrays import FloatArray

MAX_TASKS = 24
"""Largest number of tasks that a prediction uses: the most similar ones. More only cost time."""

MAX_PERSONS = 64
"""Largest number of persons that a prediction uses: those who did most of the same tasks."""

TEMPO_SLACK = 0.15
"""In log seconds: how much quicker or slower a prediction may be than all persons who did the
task."""


@dataclass(frozen=True, slots=True)
class Predicted:
    """A predicted motion.

    shape: (1378,) the motion shape; follows: the person whose motion it follows, if the persons
    who did the task do not agree; agreement: their agreement; for a single person that of their
    takes, None for a single take.
    """

    shape: FloatArray
    follows: str | None
    agreement: float | None


def predict(
    record: Synthesis, given: Mapping[str, FloatArray], task: str, exclude: Sequence[str] = ()
) -> Predicted:
    """Predict `task` for a person whose motion shapes (1378,) of other tasks are `given`.

    exclude: persons to leave out, such as the person themselves. Raises NotEnoughLabels if nobody
    else did the task, or if nobody who did it did a task of the person.
    """
    usable = {name: shape for name, shape in given.items() if name in record.tasks and name != task}
    others = [name for name in record.who_did(task) if name not in exclude]
    if not usable:
        raise NotEnoughLabels("The person must have a clip of another task of the library.")
    if not others:
        raise NotEnoughLabels(f"Another person must have a clip of the task {task}.")
    chosen = _most_alike(record, usable, task)
    others = _who_shares_most(record, others, chosen)
    own = own_motions(record, {name: usable[name] for name in chosen})
    aim = target_motions(record, task, others, own)
    known = basis_tensor(record, others, own, aim.timed)
    follows = None
    if agree(aim.agreement):
        shape, timing = _made_of_all(known, aim.timed, own.timed)
    else:
        shape, timing = _following(known, aim, own.timed)
        follows = others[aim.most_like_all]
    if shape[-1] < 0.5:
        shape = to_own_time(shape, timing)
    return Predicted(shape, follows, aim.agreement)


def _made_of_all(known: BasisTensor, wanted: Timed, own: Timed) -> tuple[FloatArray, FloatArray]:
    """A shape (1378,) and its timing (32,), both solved from the other tasks."""
    solution = solve(known.basis, wanted.shapes, own.shapes)
    difference = solution.weights @ (own.timing - known.timing.mean(axis=0))
    timing = wanted.timing.mean(axis=0) + solution.carried * difference
    return _as_one_does_it(solution.shape, wanted.shapes), timing


def _following(
    known: BasisTensor, wanted: TargetMotions, own: Timed
) -> tuple[FloatArray, FloatArray]:
    """A shape (1378,) and timing (32,) from the person who is most like all others."""
    one = wanted.most_like_all
    theirs = wanted.timed.shapes[one]
    shape = follow(known.basis[one], theirs, own.shapes)
    return _as_one_does_it(shape, theirs[None]), wanted.timed.timing[one]


def _as_one_does_it(shape: FloatArray, wanted: FloatArray) -> FloatArray:
    """The shape (1378,), cyclic or not, with a speed and height like those of the others
    (K, 1378)."""
    shape = np.array(shape)
    shape[-1] = float(np.mean(wanted[:, -1]) >= 0.5)
    shortest, longest = wanted[:, -2].min(), wanted[:, -2].max()
    shape[-2] = np.clip(shape[-2], shortest - TEMPO_SLACK, longest + TEMPO_SLACK)
    return _off_the_floor(shape, wanted)


def _off_the_floor(shape: FloatArray, wanted: FloatArray) -> FloatArray:
    """The shape (1378,) at the height above the floor of a person who does the task (K, 1378).

    Legs and hips have separate weights, so bent knees could leave the feet in the air.
    """
    moments = shape[:-2].reshape(SAMPLES, CHANNELS)
    there = clearance(wanted[:, :-2].reshape(-1, SAMPLES, CHANNELS))
    now = clearance(moments)
    moments[:, 39] += np.clip(now, there.min(axis=0), there.max(axis=0)) - now
    return np.concatenate([moments.ravel(), shape[-2:]])


def _most_alike(record: Synthesis, usable: Mapping[str, FloatArray], task: str) -> list[str]:
    """The tasks that are most similar to the wanted one, as they are or mirrored."""
    if len(usable) <= MAX_TASKS:
        return list(usable)
    scale, aim = weights(), record.reference(task)
    means = np.stack([record.reference(name) for name in usable])
    away = [np.linalg.norm((rows - aim) * scale, axis=1) for rows in (means, mirrored(means))]
    near = np.argsort(np.min(away, axis=0), kind="stable")[:MAX_TASKS]
    names = list(usable)
    return [names[i] for i in np.sort(near)]


def _who_shares_most(record: Synthesis, persons: list[str], tasks: list[str]) -> list[str]:
    """The persons who did most of these tasks, since they have the fewest missing cells."""
    if len(persons) <= MAX_PERSONS:
        return persons
    wanted = np.isin(record.task, [record.tasks.index(name) for name in tasks])
    shared = np.bincount(record.person[wanted], minlength=len(record.persons))
    count = [shared[record.persons.index(name)] for name in persons]
    return [persons[i] for i in np.sort(np.argsort(-np.array(count), kind="stable")[:MAX_PERSONS])]
