"""The side of each take of a task: done with the right hand (or leg), or with the left.

The mean of a left and a right kick is not a kick. A task has two sides if mirroring some of its
takes makes all takes much more similar. These takes are mirrored before means are computed. Takes
of different tasks are never compared, since the side may be the difference between two tasks.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.analysis.descriptors.motion_shape import mirrored
from app.models.synthesis.basis import weights
from app.numerics.arrays import FloatArray, IntArray
from app.numerics.signs import fix_signs

MAX_SCATTER_LEFT = 0.8
"""A task has two sides if mirroring lowers the scatter of its takes to at most this share.
Measured: 1.00 for all tasks of real clips except a dance; .45 for the demo's kicks, .23 for its
waves."""

ROUNDS = 4
"""Rounds of assigning sides by the mean; few takes change after the first round."""


def sides(shapes: FloatArray) -> IntArray:
    """(n,) the side of each of the motion shapes (n, 1378) of one task: +1 or -1.

    +1 is the more frequent side (or the side of the first take if both are equally frequent).
    All are 0 if the task has no sides or is cyclic.
    """
    none = np.zeros(len(shapes), dtype=np.int64)
    if len(shapes) < 2 or (shapes[:, -1] >= 0.5).any():
        return none
    rows = np.asarray(shapes, dtype=np.float64)
    asymmetric = (rows - mirrored(rows)) / 2 * weights()
    gram = asymmetric @ asymmetric.T
    side = _halves(gram)
    if abs(side.sum()) == len(side):
        return none
    # mirroring keeps norms; it changes only the part of the mean that differs between the sides
    centered = (rows - rows.mean(axis=0)) * weights()
    scatter = float((centered**2).sum())
    gained = float(side @ gram @ side - gram.sum()) / len(side)
    if gained < (1 - MAX_SCATTER_LEFT) * scatter:
        return none
    return side * (1 if (side.sum() or side[0]) > 0 else -1)


def to_side(shapes: FloatArray, side: IntArray, target: int | IntArray) -> FloatArray:
    """(n, 1378) the motion shapes (n, 1378), mirrored if their side is not the target side.

    side: (n,) their sides; target: one side, or (n,) sides. A shape stays as it is if one of the
    two is 0.
    """
    changed = np.asarray(side) * target < 0
    turned = np.array(shapes, dtype=np.float64)
    if changed.any():
        turned[changed] = mirrored(turned[changed])
    return turned


def likely_side(
    own_sides: Sequence[int], other_sides: Sequence[IntArray], target_sides: IntArray
) -> int:
    """The likely side, +1 or -1, of the target task by a person who never did it.

    own_sides: (T,) the sides of the person's other tasks. other_sides: for each of these tasks,
    the sides (K,) of K other persons. target_sides: (K,) the sides to which these persons did the
    target task. 0 is an unknown side. The result follows the correlation of the sides of the
    tasks. Without correlation, it is the most frequent side.
    """
    votes = 0.0
    for own, others in zip(own_sides, other_sides, strict=True):
        known = (others != 0) & (target_sides != 0)
        if own and known.any():
            votes += own * float(np.mean(others[known] * target_sides[known]))
    if abs(votes) < 1e-9:
        votes = float(target_sides.sum()) or 1.0
    return 1 if votes > 0 else -1


def _halves(gram: FloatArray) -> IntArray:
    """(n,) signs +1 and -1 that make the norm of the signed sum of n vectors large.

    gram: (n, n) their inner products.
    """
    _, vectors = np.linalg.eigh(gram)
    first = fix_signs(vectors[:, -1:])[:, 0]
    side = np.where(first >= 0, 1, -1)
    for _ in range(ROUNDS):
        side = np.where(gram @ side >= 0, 1, -1)
    return side
