"""Predicts the motion of a person at a task from their motions at other tasks.

The cells are collected and aligned (app.models.synthesis.tensor), and the target task is solved for
(app.models.synthesis.solving). Then the solution is warped from the time of the task to its own
time.
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
"""Largest number of tasks that a prediction uses: the most similar ones. More tasks make it slower,
not better."""

MAX_PERSONS = 64
"""Largest number of persons that a prediction uses: the persons with most of the same tasks."""

TEMPO_SLACK = 0.15
"""Largest difference, in log seconds, between the duration of a prediction and the range of the
durations of the persons who did the task."""


@dataclass(frozen=True, slots=True)
class Predicted:
    """A predicted motion.

    shape: (1378,) the motion shape. follows: if the persons who did the task do not agree, the
    person whose motion the prediction follows, else None. agreement: between the persons, or
    between the takes of a single person, None for a single take.
    """

    shape: FloatArray
    follows: str | None
    agreement: float | None


def predict(
    record: Synthesis, given: Mapping[str, FloatArray], task: str, exclude: Sequence[str] = ()
) -> Predicted:
    """Predict `task` for a person, from the motion shapes (1378,) of this person by task, `given`.

    exclude: persons that are not used, such as the person themselves. Raises NotEnoughLabels if
    `given` has no other task of the library, or if nobody else did `task`.
    """
    usable = {name: shape for name, shape in given.items() if name in record.tasks and name != task}
    others = [name for name in record.who_did(task) if name not in exclude]
    if not usable:
        raise NotEnoughLabels("The person must have a clip of another task of the library.")
    if not others:
        raise NotEnoughLabels(f"Another person must have a clip of the task {task}.")
    chosen = _most_similar_tasks(record, usable, task)
    others = _persons_with_most_tasks(record, others, chosen)
    own = own_motions(record, {name: usable[name] for name in chosen})
    target = target_motions(record, task, others, own)
    tensor = basis_tensor(record, others, own, target.timed)
    follows = None
    if agree(target.agreement):
        shape, timing = _combined(tensor, target.timed, own.timed)
    else:
        shape, timing = _following(tensor, target, own.timed)
        follows = others[target.most_typical]
    if shape[-1] < 0.5:  # cycles are not warped
        shape = to_own_time(shape, timing)
    return Predicted(shape, follows, target.agreement)


def _combined(tensor: BasisTensor, target: Timed, own: Timed) -> tuple[FloatArray, FloatArray]:
    """A shape (1378,) and its timing (32,), both solved from the other tasks of all persons."""
    solution = solve(tensor.basis, target.shapes, own.shapes)
    difference = solution.weights @ (own.timing - tensor.timing.mean(axis=0))
    timing = target.timing.mean(axis=0) + solution.share_of_difference * difference
    return _with_usual_tempo(solution.shape, target.shapes), timing


def _following(
    tensor: BasisTensor, target: TargetMotions, own: Timed
) -> tuple[FloatArray, FloatArray]:
    """A shape (1378,) and its timing (32,) that follow the most typical person."""
    leader = target.most_typical
    led = target.timed.shapes[leader]
    shape = follow(tensor.basis[leader], led, own.shapes)
    return _with_usual_tempo(shape, led[None]), target.timed.timing[leader]


def _with_usual_tempo(shape: FloatArray, others: FloatArray) -> FloatArray:
    """The shape (1378,) with duration, height and kind (cyclic or not) limited to usual ones.

    others: (K, 1378) the shapes of the persons who did the task.
    """
    shape = np.array(shape)
    shape[-1] = float(np.mean(others[:, -1]) >= 0.5)
    low, high = others[:, -2].min(), others[:, -2].max()  # log seconds
    shape[-2] = np.clip(shape[-2], low - TEMPO_SLACK, high + TEMPO_SLACK)
    return _at_usual_height(shape, others)


def _at_usual_height(shape: FloatArray, others: FloatArray) -> FloatArray:
    """The shape (1378,) moved to a height above the floor within that of the others (K, 1378).

    Legs and hips have separate weights. So without this, bent knees could leave the feet in the
    air.
    """
    moments = shape[:-2].reshape(SAMPLES, CHANNELS)
    usual = clearance(others[:, :-2].reshape(-1, SAMPLES, CHANNELS))
    own = clearance(moments)
    moments[:, 39] += np.clip(own, usual.min(axis=0), usual.max(axis=0)) - own
    return np.concatenate([moments.ravel(), shape[-2:]])


def _most_similar_tasks(
    record: Synthesis, usable: Mapping[str, FloatArray], task: str
) -> list[str]:
    """At most MAX_TASKS of the tasks: those most similar to `task`, mirrored or not."""
    if len(usable) <= MAX_TASKS:
        return list(usable)
    scale, target = weights(), record.reference(task)
    means = np.stack([record.reference(name) for name in usable])
    distances = [
        np.linalg.norm((rows - target) * scale, axis=1) for rows in (means, mirrored(means))
    ]
    near = np.argsort(np.min(distances, axis=0), kind="stable")[:MAX_TASKS]
    names = list(usable)
    return [names[i] for i in np.sort(near)]


def _persons_with_most_tasks(record: Synthesis, persons: list[str], tasks: list[str]) -> list[str]:
    """At most MAX_PERSONS of the persons: those who did most of these tasks.

    They have the fewest missing cells.
    """
    if len(persons) <= MAX_PERSONS:
        return persons
    is_shared = np.isin(record.task, [record.tasks.index(name) for name in tasks])
    shared = np.bincount(record.person[is_shared], minlength=len(record.persons))
    count = [shared[record.persons.index(name)] for name in persons]
    return [persons[i] for i in np.sort(np.argsort(-np.array(count), kind="stable")[:MAX_PERSONS])]
