"""The parameters of a task, solved jointly (Vasilescu 2002, eq. 8), and what they make.

The weights w with which the tasks that the asked person did make the wanted one of other
persons' motions are found over all these persons at once (least squares, not a mean of
inverses); the same w makes it of the person's own. Beyond the paper, each of which raised the
held-out hits (tests/bench/test_synthesis.py):
- what w leaves over of the others' motions is carried over as their mean ("residual");
- the parts of the body have weights of their own, drawn towards those of the whole;
- a mirrored task is a task: raising the left hand tells how one raises the right.
"""

from __future__ import annotations

import numpy as np

from app.analysis.motion_shape import SHAPE_LENGTH, mirrored
from app.models.synthesis_basis import parts, weights
from app.numerics.arrays import FloatArray

WHOLE_RIDGE = 0.01
"""Pull of the weights of the whole towards the mean of the tasks, in mean squares of a task."""

PART_RIDGE = 0.02
"""Pull of a part's weights towards those of the whole, likewise."""


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
