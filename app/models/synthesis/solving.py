"""The parameters of a task, solved jointly (Vasilescu 2002, eq. 8), and what they make.

The weights w with which the tasks that the asked person did make the wanted one of other
persons' motions are found over all these persons at once (least squares, not a mean of
inverses); the same w makes it of the person's own. Beyond the paper, each of which raised the
held-out hits (tests/bench/test_synthesis.py) but for the second, which brought what is made
nearer to what was left out:
- what w leaves over of the others' motions is carried over as their mean ("residual");
- how the asked person moves otherwise than the others is carried over as far as the tasks'
  movements tell of each other: a kick's does not belong into a bow, how one stands in both does;
- the parts of the body have weights of their own, drawn toward those of the whole;
- a mirrored task is a task: raising the left hand tells how one raises the right.
Where the others do not agree on the task no weights make it of other tasks: one of the others is
followed, and only the asked person's posture carried over.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.analysis.descriptors.motion_sample import SAMPLES
from app.analysis.descriptors.motion_shape import CHANNELS, SHAPE_LENGTH, mirrored
from app.models.synthesis.basis import parts, weights
from app.numerics.arrays import FloatArray

WHOLE_RIDGE = 0.01
"""Pull of the weights of the whole toward the mean of the tasks, in mean squares of a task."""

PART_RIDGE = 0.02
"""Pull of a part's weights toward those of the whole, likewise."""

EXPLAINED = 0.5
"""Share of a task's movement that must come of the other tasks for a person's own way of moving
to be carried over whole; with less it is in proportion."""


@dataclass(frozen=True, slots=True)
class Solution:
    """shape: (1378,) what is made; weights: (T,) of the tasks, themselves and mirrored, for the
    body as a whole; carried: share 0..1 of what it moves otherwise that was carried over."""

    shape: FloatArray
    weights: FloatArray
    carried: float


def solve(basis: FloatArray, wanted: FloatArray, own: FloatArray) -> Solution:
    """What K persons did and the wanted task by each, (K, T, 1378), (K, 1378), and what the asked
    person did, (T, 1378): eq. 8 jointly, and the residual carried over."""
    scale, tasks = weights(), basis.shape[1]
    both = np.concatenate([basis, _mirrored(basis)], axis=1) * scale  # (K, 2T, d)
    asked = np.concatenate([own, mirrored(own)]) * scale  # (2T, d)
    target = wanted * scale
    prior = np.concatenate([np.full(tasks, 1 / tasks), np.zeros(tasks)])
    beside = asked - both.mean(axis=0)
    split = [(part, np.take(both, part, axis=2)) for part in parts()]
    normal = [_normal(basis, target[:, part]) for part, basis in split]
    gram, aim = (np.sum([pair[i] for pair in normal], axis=0) for i in range(2))
    shared = _ridge(gram, aim, prior, WHOLE_RIDGE)
    made, apart = np.empty_like(target), np.empty(SHAPE_LENGTH)
    for (part, basis), (gram, aim) in zip(split, normal, strict=True):
        w = _ridge(gram, aim, shared, PART_RIDGE)
        made[:, part] = np.matmul(w, basis)
        apart[part] = w @ beside[:, part]
    held, of_each = _held(apart), shared[:tasks] + shared[tasks:]
    carried = min(_explained(made, target) / EXPLAINED, 1.0)
    shape = (target.mean(axis=0) + held + carried * (apart - held)) / scale
    return Solution(shape, of_each, carried)


def follow(basis: FloatArray, wanted: FloatArray, own: FloatArray) -> FloatArray:
    """(1378,) what one person did of the wanted task, (1378,), in the posture of another; of what
    both did otherwise, (T, 1378) by each. How the whole goes and lasts stays as it is: how one
    walks is not how one goes about another's dance."""
    posture = _held((own - basis).mean(axis=0))
    posture[parts()[-1]] = 0.0
    return np.asarray(wanted + posture)


def effects_only(basis: FloatArray, wanted: FloatArray, own: FloatArray) -> FloatArray:
    """As `solve`, by person and task effects added up: a baseline."""
    return np.asarray(own.mean(axis=0) + (wanted - basis.mean(axis=1)).mean(axis=0))


def _held(shapes: FloatArray) -> FloatArray:
    """(..., 1378) the mean over the 32 moments in each; how long, and whether cyclic, as it is."""
    moments = shapes[..., :-2].reshape(*shapes.shape[:-1], SAMPLES, CHANNELS)
    mean = np.broadcast_to(moments.mean(axis=-2, keepdims=True), moments.shape)
    flat = mean.reshape(*shapes.shape[:-1], SAMPLES * CHANNELS)
    return np.concatenate([flat, shapes[..., -2:]], axis=-1)


def _explained(made: FloatArray, target: FloatArray) -> float:
    """Share 0..1 of the movement in `target` (K, 1378) that is in `made`, squares summed."""
    moving = target - _held(target)
    left = moving - (made - _held(made))
    return max(0.0, 1.0 - float((left**2).sum() / max((moving**2).sum(), 1e-12)))


def _normal(basis: FloatArray, target: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(2T, 2T) and (2T,): the normal equations of all persons together."""
    gram = np.matmul(basis, basis.transpose(0, 2, 1)).sum(axis=0)
    return gram, np.matmul(basis, target[:, :, None]).sum(axis=0)[:, 0]


def _ridge(gram: FloatArray, aim: FloatArray, prior: FloatArray, ridge: float) -> FloatArray:
    """(2T,) weights nearest to the aim, drawn toward `prior`."""
    size = len(gram)
    pull = ridge * float(np.trace(gram)) / size + 1e-12
    return np.asarray(prior + np.linalg.solve(gram + pull * np.eye(size), aim - gram @ prior))


def _mirrored(basis: FloatArray) -> FloatArray:
    return mirrored(basis.reshape(-1, SHAPE_LENGTH)).reshape(basis.shape)
