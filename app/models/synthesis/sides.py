"""Which side takes of a task are done to: with the right hand, or with the left.

Half of a kick with either leg is no kick. Where the takes of a task are truly of two sides,
that is where changing left and right in some of them makes all of them much more alike, those
are mirrored before means are taken. Takes of different tasks are never held against each other:
there the side may be what makes the task.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.analysis.descriptors.motion_shape import mirrored
from app.models.synthesis.basis import weights
from app.numerics.arrays import FloatArray, IntArray
from app.numerics.signs import fix_signs

LEFT_OF_SCATTER = 0.8
"""Share of the takes' scatter that may be left when some are mirrored, for a task of two sides.
On all tasks of real clips but a dance 1.00 were left; of the demo's kicks .45, of waves .23."""

ROUNDS = 4
"""Of changing sides toward the mean; few takes change after the first."""


def sides(shapes: FloatArray) -> IntArray:
    """(n,) of motion shapes (n, 1378) of one task, +1 or -1 by side, +1 for the more frequent
    (else for the first take's); all 0 where the task is not of two sides, or goes round."""
    none = np.zeros(len(shapes), dtype=np.int64)
    if len(shapes) < 2 or (shapes[:, -1] >= 0.5).any():
        return none
    rows = np.asarray(shapes, dtype=np.float64)
    apart = (rows - mirrored(rows)) / 2 * weights()
    gram = apart @ apart.T
    side = _halves(gram)
    if abs(side.sum()) == len(side):
        return none
    # mirroring keeps lengths, and of the mean changes only what differs between the sides
    centred = (rows - rows.mean(axis=0)) * weights()
    scatter = float((centred**2).sum())
    gained = float(side @ gram @ side - gram.sum()) / len(side)
    if gained < (1 - LEFT_OF_SCATTER) * scatter:
        return none
    return side * (1 if (side.sum() or side[0]) > 0 else -1)


def to_side(shapes: FloatArray, side: IntArray, wanted: int | IntArray) -> FloatArray:
    """(n, 1378) motion shapes (n, 1378) of which those of the other side than `wanted`, one or
    (n,), are mirrored; side: (n,) their sides, where either is 0 they stay as they are."""
    changed = np.asarray(side) * wanted < 0
    turned = np.array(shapes, dtype=np.float64)
    if changed.any():
        turned[changed] = mirrored(turned[changed])
    return turned


def likely_side(asked: Sequence[int], theirs: Sequence[IntArray], wanted: IntArray) -> int:
    """The side, +1 or -1, to which someone does a task who does others to the sides `asked`.

    theirs: for each of these tasks the sides (K,) of the K persons who did the wanted task, to
    the sides `wanted` (K,); 0 where not known. As far as persons do both to related sides this
    tells; else the side that most of them take.
    """
    votes = 0.0
    for own, others in zip(asked, theirs, strict=True):
        known = (others != 0) & (wanted != 0)
        if own and known.any():
            votes += own * float(np.mean(others[known] * wanted[known]))
    if abs(votes) < 1e-9:
        votes = float(wanted.sum()) or 1.0
    return 1 if votes > 0 else -1


def _halves(gram: FloatArray) -> IntArray:
    """(n,) +1 and -1 that make the sum of what these are the inner products of long."""
    _, vectors = np.linalg.eigh(gram)
    first = fix_signs(vectors[:, -1:])[:, 0]
    side = np.where(first >= 0, 1, -1)
    for _ in range(ROUNDS):
        side = np.where(gram @ side >= 0, 1, -1)
    return side
