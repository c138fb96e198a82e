"""Which side takes of a task are done to: with the right hand, or with the left.

Half of a kick with either leg is no kick. Where the takes of a task are truly of two sides,
that is where changing left and right in some of them makes all of them agree much more, those
are mirrored before means are taken. Takes of different tasks are never held against each other:
there the side may be what makes the task.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.analysis.motion_sample import SAMPLES
from app.analysis.motion_shape import CHANNELS, mirrored
from app.models.synthesis_agreement import agreement
from app.models.synthesis_basis import weights
from app.models.synthesis_timing import medoid, moments_of_shapes, together
from app.models.synthesis_warping import read_at, warping_times
from app.numerics.arrays import FloatArray, IntArray

LEFT_APART = 0.65
"""Share of what takes do not agree in that may be left when some are mirrored, for a task of two
sides. Of the demo's gestures by left- and right-handers .12 to .58 is left, of real takes of a
task by one hand .94 to 1.0, of unlike dances by one person .75 and more."""

LEAST_GAIN = 0.1
"""Of agreement: what agrees nearly wholly is of one side, whatever noise gains."""

ROUNDS = 3
"""Of taking each take to the side on which it is more like the mean, and the mean of these."""


def sides(shapes: FloatArray) -> IntArray:
    """(n,) of motion shapes (n, 1378) of one task, +1 or -1 by side, +1 for the more frequent
    (else for the first take's); all 0 where the task is not of two sides, or goes round.

    Takes are compared in one course of time: of gestures that begin at other times neither side
    would be alike.
    """
    none = np.zeros(len(shapes), dtype=np.int64)
    if len(shapes) < 2 or (shapes[:, -1] >= 0.5).any() or not _may_be_mirrored(shapes):
        return none
    side = _nearer_sides(shapes)
    if abs(side.sum()) == len(side):
        return none
    as_done = agreement(together(shapes, none).shapes)
    to_one = agreement(together(to_side(shapes, side, 1), none).shapes)
    if to_one - as_done < LEAST_GAIN or 1 - to_one > LEFT_APART * (1 - as_done):
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


def _may_be_mirrored(shapes: FloatArray) -> bool:
    """Whether any of (n, 1378) is clearly more like another one's mirror image: quickly, without
    a look at when it is done."""
    rows = _movement(shapes)
    alike, mirrored_alike = rows @ rows.T, rows @ _movement(mirrored(shapes)).T
    length = np.sqrt(np.diag(alike))
    return bool((mirrored_alike - alike > LEAST_GAIN * np.outer(length, length)).any())


def _nearer_sides(shapes: FloatArray) -> IntArray:
    """(n,) +1 and -1: on which side each is more like the mean of all, which starts as the one
    most like the others."""
    count = len(shapes)
    both = np.concatenate([shapes, mirrored(shapes)])
    moving = _movement(both).reshape(2 * count, SAMPLES, -1)
    mean = moving[medoid(moving[:count].reshape(count, -1))]
    side = np.ones(count, dtype=np.int64)
    for _ in range(ROUNDS):
        timed = read_at(moving, warping_times(moving, np.repeat(mean[None], 2 * count, axis=0)))
        away = ((timed - mean) ** 2).sum(axis=(1, 2))
        side = np.where(away[:count] <= away[count:], 1, -1)
        mean = np.concatenate([timed[:count][side > 0], timed[count:][side < 0]]).mean(axis=0)
    return side


def _movement(shapes: FloatArray) -> FloatArray:
    """(n, 1376) each channel beside its mean, weighted."""
    moments = moments_of_shapes(np.asarray(shapes, dtype=np.float64))
    moving = (moments - moments.mean(axis=1, keepdims=True)) * weights()[:CHANNELS]
    return np.asarray(moving.reshape(len(shapes), -1))
