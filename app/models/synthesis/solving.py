"""Solves for the parameters of a task (Vasilescu 2002, eq. 8) and predicts its motion.

Weights w express the target task as a combination of other tasks. They are fitted to all other
persons at once (least squares, not a mean of inverses). Then w is applied to the tasks of the
target person. There are four additions to the paper. All but the second raised the held-out hits
(tests/bench/test_synthesis.py); the second brought predictions nearer to the left-out motions.
- The residual of the fit is added as its mean over the other persons.
- The difference between the target person and the others is added in proportion to how well the
  tasks explain each other. The difference in a kick does not belong in a bow; the difference in
  standing belongs in both.
- The parts of the body have separate weights, shrunk toward those of the whole body.
- A mirrored task is another task: raising the left hand helps to predict raising the right.
If the others do not agree on the task, no weights can express it. Then the prediction follows one
of the others, and adds only the posture of the target person.
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

    shape: (1378,) the predicted shape; weights: (T,) the sum of the weights of each task and of
    its mirrored copy, for the whole body; share_of_difference: the share, 0..1, of the person's
    difference that was added.
    """

    shape: FloatArray
    weights: FloatArray
    share_of_difference: float


def solve(basis: FloatArray, target: FloatArray, own: FloatArray) -> Solution:
    """Solve eq. 8 for all persons jointly, and add the residual.

    basis: (K, T, 1378) shapes of T tasks by K other persons; target: (K, 1378) the target task by
    each of them; own: (T, 1378) the T tasks by the target person.
    """
    scale, tasks = weights(), basis.shape[1]
    both = np.concatenate([basis, _mirrored(basis)], axis=1) * scale  # (K, 2T, d)
    own_both = np.concatenate([own, mirrored(own)]) * scale  # (2T, d)
    scaled = target * scale
    prior = np.concatenate([np.full(tasks, 1 / tasks), np.zeros(tasks)])
    difference = own_both - both.mean(axis=0)
    split = [(part, np.take(both, part, axis=2)) for part in parts()]
    normal = [_normal(basis, scaled[:, part]) for part, basis in split]
    # the normal equations of the whole body are the sums of those of its parts
    gram, products = (np.sum([pair[i] for pair in normal], axis=0) for i in range(2))
    whole = _ridge(gram, products, prior, WHOLE_RIDGE)
    fitted, personal = np.empty_like(scaled), np.empty(SHAPE_LENGTH)
    for (part, basis), (gram, products) in zip(split, normal, strict=True):
        w = _ridge(gram, products, whole, PART_RIDGE)
        fitted[:, part] = np.matmul(w, basis)
        personal[part] = w @ difference[:, part]
    posture = _posture(personal)
    share = min(_explained(fitted, scaled) / EXPLAINED, 1.0)
    # The mean of the target task is the mean of the fit plus the mean residual. The difference in
    # posture is added in full, the difference in movement by its share.
    shape = (scaled.mean(axis=0) + posture + share * (personal - posture)) / scale
    return Solution(shape, whole[:tasks] + whole[tasks:], share)


def follow(basis: FloatArray, target: FloatArray, own: FloatArray) -> FloatArray:
    """(1378,) the target task by another person, in the posture of the target person.

    basis, own: (T, 1378) other tasks by the followed and by the target person; target: (1378,)
    the target task by the followed person. Path and duration stay those of the followed person,
    because the walk of one person says nothing about the path of another person's dance.
    """
    posture = _posture((own - basis).mean(axis=0))
    posture[parts()[-1]] = 0.0  # path and duration
    return np.asarray(target + posture)


def effects_only(basis: FloatArray, target: FloatArray, own: FloatArray) -> FloatArray:
    """(1378,) the sum of person and task effects, a baseline; parameters as in `solve`."""
    return np.asarray(own.mean(axis=0) + (target - basis.mean(axis=1)).mean(axis=0))


def _posture(shapes: FloatArray) -> FloatArray:
    """(..., 1378) motionless shapes: each moment is the mean of the 32 moments of `shapes`.

    Duration and cyclicity stay as they are.
    """
    moments = shapes[..., :-2].reshape(*shapes.shape[:-1], SAMPLES, CHANNELS)
    mean = np.broadcast_to(moments.mean(axis=-2, keepdims=True), moments.shape)
    flat = mean.reshape(*shapes.shape[:-1], SAMPLES * CHANNELS)
    return np.concatenate([flat, shapes[..., -2:]], axis=-1)


def _explained(fitted: FloatArray, target: FloatArray) -> float:
    """The share, 0..1, of the squared movement of `target` (K, 1378) that `fitted` explains."""
    movement = target - _posture(target)
    residual = movement - (fitted - _posture(fitted))
    return max(0.0, 1.0 - float((residual**2).sum() / max((movement**2).sum(), 1e-12)))


def _normal(basis: FloatArray, target: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(2T, 2T) and (2T,): the sums of the normal equations of all persons."""
    gram = np.matmul(basis, basis.transpose(0, 2, 1)).sum(axis=0)
    return gram, np.matmul(basis, target[:, :, None]).sum(axis=0)[:, 0]


def _ridge(gram: FloatArray, products: FloatArray, prior: FloatArray, ridge: float) -> FloatArray:
    """(2T,) the solution of the normal equations, shrunk toward `prior` (2T,)."""
    size = len(gram)
    pull = ridge * float(np.trace(gram)) / size + 1e-12
    return np.asarray(prior + np.linalg.solve(gram + pull * np.eye(size), products - gram @ prior))


def _mirrored(basis: FloatArray) -> FloatArray:
    return mirrored(basis.reshape(-1, SHAPE_LENGTH)).reshape(basis.shape)
