"""Solves for the parameters of a task (Vasilescu 2002, eq. 8) and predicts its motion.

Weights w express the wanted task as a combination of other tasks. They are fitted over all other
persons at once (least squares, not a mean of inverses). Then w is applied to the asked person's own
tasks. There are four additions to the paper. All but the second raised the held-out hits
(tests/bench/test_synthesis.py); the second brought predictions nearer to the left-out motions.
- The residual of the fit is added as its mean over the other persons.
- The difference between the asked person and the others is added in proportion to how well the
  tasks explain each other. The difference in a kick does not belong in a bow; the difference in
  standing belongs in both.
- The parts of the body have separate weights, shrunk toward those of the whole body.
- A mirrored task is another task: raising the left hand helps to predict raising the right.
If the others do not agree on the task, no weights can express it. Then the prediction follows one
of the others, and adds only the posture of the asked person.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.analysis.descriptors.motion_sample import SAMPLES
from app.analysis.descriptors.motion_shape import CHANNELS, SHAPE_LENGTH, mirrored
from app.models.synthesis.basis import parts, weights
from app.numerics.arrays import FloatArray

WHOLE_RIDGE = 0.01
"""Ridge penalty that shrinks the weights of the whole body toward the mean of the tasks, relative
to the mean square of a task."""

PART_RIDGE = 0.02
"""Ridge penalty that shrinks the weights of a part toward those of the whole, likewise relative."""

EXPLAINED = 0.5
"""If the other tasks explain at least this share of the movement of a task, the person's difference
is added in full, else in proportion."""


@dataclass(frozen=True, slots=True)
class Solution:
    """A solution.

    shape: (1378,) the predicted shape; weights: (T,) weight of each task for the whole body, as
    it is and mirrored together; carried: share 0..1 of the person's difference that was added.
    """

    shape: FloatArray
    weights: FloatArray
    carried: float


def solve(basis: FloatArray, wanted: FloatArray, own: FloatArray) -> Solution:
    """Solve eq. 8 for all persons jointly, and add the residual.

    basis: (K, T, 1378) shapes of T tasks by K other persons; wanted: (K, 1378) the wanted task by
    each of them; own: (T, 1378) the T tasks by the asked person.
    """
    scale, tasks = weights(), basis.shape[1]
    both = np.concatenate([basis, _mirrored(basis)], axis=1) * scale  # (K, 2T, d)
    asked = np.concatenate([own, mirrored(own)]) * scale  # (2T, d)
    target = wanted * scale
    prior = np.concatenate([np.full(tasks, 1 / tasks), np.zeros(tasks)])
    difference = asked - both.mean(axis=0)
    split = [(part, np.take(both, part, axis=2)) for part in parts()]
    normal = [_normal(basis, target[:, part]) for part, basis in split]
    gram, aim = (np.sum([pair[i] for pair in normal], axis=0) for i in range(2))
    shared = _ridge(gram, aim, prior, WHOLE_RIDGE)
    made, apart = np.empty_like(target), np.empty(SHAPE_LENGTH)
    for (part, basis), (gram, aim) in zip(split, normal, strict=True):
        w = _ridge(gram, aim, shared, PART_RIDGE)
        made[:, part] = np.matmul(w, basis)
        apart[part] = w @ difference[:, part]
    held, of_each = _held(apart), shared[:tasks] + shared[tasks:]
    carried = min(_explained(made, target) / EXPLAINED, 1.0)
    shape = (target.mean(axis=0) + held + carried * (apart - held)) / scale
    return Solution(shape, of_each, carried)


def follow(basis: FloatArray, wanted: FloatArray, own: FloatArray) -> FloatArray:
    """(1378,) the wanted task by another person, in the posture of the asked person.

    basis, own: (T, 1378) other tasks by the followed and by the asked person; wanted: (1378,)
    the wanted task by the followed person. Path and duration stay those of the followed person:
    the way one walks does not change the path of another person's dance.
    """
    posture = _held((own - basis).mean(axis=0))
    posture[parts()[-1]] = 0.0
    return np.asarray(wanted + posture)


def effects_only(basis: FloatArray, wanted: FloatArray, own: FloatArray) -> FloatArray:
    """(1378,) the sum of person and task effects, a baseline; parameters as in `solve`."""
    return np.asarray(own.mean(axis=0) + (wanted - basis.mean(axis=1)).mean(axis=0))


def _held(shapes: FloatArray) -> FloatArray:
    """(..., 1378) shapes with the mean over the 32 moments in each moment; duration and cyclicity
    unchanged."""
    moments = shapes[..., :-2].reshape(*shapes.shape[:-1], SAMPLES, CHANNELS)
    mean = np.broadcast_to(moments.mean(axis=-2, keepdims=True), moments.shape)
    flat = mean.reshape(*shapes.shape[:-1], SAMPLES * CHANNELS)
    return np.concatenate([flat, shapes[..., -2:]], axis=-1)


def _explained(made: FloatArray, target: FloatArray) -> float:
    """The share 0..1 of the movement in `target` (K, 1378) that `made` explains (by squares)."""
    moving = target - _held(target)
    left = moving - (made - _held(made))
    return max(0.0, 1.0 - float((left**2).sum() / max((moving**2).sum(), 1e-12)))


def _normal(basis: FloatArray, target: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(2T, 2T) and (2T,): the sums of the normal equations of all persons."""
    gram = np.matmul(basis, basis.transpose(0, 2, 1)).sum(axis=0)
    return gram, np.matmul(basis, target[:, :, None]).sum(axis=0)[:, 0]


def _ridge(gram: FloatArray, aim: FloatArray, prior: FloatArray, ridge: float) -> FloatArray:
    """(2T,) the solution of the normal equations, shrunk toward `prior` (2T,)."""
    size = len(gram)
    pull = ridge * float(np.trace(gram)) / size + 1e-12
    return np.asarray(prior + np.linalg.solve(gram + pull * np.eye(size), aim - gram @ prior))


def _mirrored(basis: FloatArray) -> FloatArray:
    return mirrored(basis.reshape(-1, SHAPE_LENGTH)).reshape(basis.shape)
