"""Many dynamic time warpings at once: which moment of a motion goes with which of a reference.

As in models.alignment, which warps one motion at a time; here hundreds of short motions are
warped in one go, along the anti-diagonals of their tables, and told as times that rise smoothly
and may lie between moments, so that what was warped can be brought back to its own time.
"""

from __future__ import annotations

import numpy as np
import scipy

from app.numerics.arrays import FloatArray, IntArray

BAND = 0.2
"""Of the length, by which a moment may be moved."""

RELUCTANCE = 0.1
"""Cost of a step that holds one of the two, beside the mean distance of two moments."""

SMOOTHING = 1.0
"""Moments (standard deviation): a path goes by whole steps, time does not."""

SLOWEST = 0.2
"""Moments of a motion that pass, at least, in one of the reference: time never stands."""


AT_ONCE = 2000
"""Motions whose tables are held in memory together: some 100 MB of 32 moments."""


def warping_times(motions: FloatArray, references: FloatArray) -> FloatArray:
    """(n, m) the time in each of `motions` (n, m, d), in moments, that goes with each moment of
    the reference in the same row of `references` (n, m, d)."""
    parts = [slice(first, first + AT_ONCE) for first in range(0, len(motions), AT_ONCE)]
    return np.concatenate([_times(motions[part], references[part]) for part in parts])


def _times(motions: FloatArray, references: FloatArray) -> FloatArray:
    squares = (motions**2).sum(-1)[:, :, None] + (references**2).sum(-1)[:, None]
    squares -= 2 * np.matmul(motions, references.transpose(0, 2, 1))
    held = held_moments(np.sqrt(np.maximum(squares, 0.0)))
    moved = held - np.arange(held.shape[1])
    smooth = scipy.ndimage.gaussian_filter1d(moved, SMOOTHING, axis=1, mode="nearest")
    return rising(smooth + np.arange(held.shape[1]))


def held_moments(cost: FloatArray) -> FloatArray:
    """(n, m) mean number of the motion's moments that the cheapest path within BAND holds
    against each of the reference's; cost: (n, m, m), the motion's moments first."""
    size = cost.shape[1]
    held = np.zeros(cost.shape[:2])
    for row, came in zip(held, _cheapest(cost), strict=True):
        steps, number = came.tolist(), [0] * size
        own, other = size - 1, size - 1
        while own >= 0:  # plain numbers: a path is walked faster so than by arrays
            row[other] += own
            number[other] += 1
            step = steps[own + other][own]
            own, other = own - (step != 2), other - (step != 1)
        row /= number
    return held


def _cheapest(cost: FloatArray) -> IntArray:
    """(n, 2 m - 1, m) from where the cheapest path comes, by the sum of both moments and the
    motion's: 0 both moved on, 1 the motion alone, 2 the reference alone.

    All cells of an anti-diagonal are reckoned together, those of every motion in one go.
    """
    count, size, _ = cost.shape
    reach = max(1, int(BAND * size))
    own, other = np.nonzero(np.abs(np.subtract.outer(np.arange(size), np.arange(size))) <= reach)
    slanted = np.full((2 * size - 1, size, count), np.inf)
    slanted[own + other, own] = cost[:, own, other].T
    reluctance = RELUCTANCE * cost.mean(axis=(1, 2))
    # two diagonals and one moment before the first, so that every cell has those before it
    total = np.full((2 * size + 1, size + 1, count), np.inf)
    total[0, 0] = 0.0
    for diagonal, here in enumerate(slanted):
        alone = np.minimum(total[diagonal + 1, :-1], total[diagonal + 1, 1:])
        alone += reluctance
        np.minimum(alone, total[diagonal, :-1], out=alone)
        np.add(alone, here, out=total[diagonal + 2, 1:])
    held = np.minimum(total[1:-1, :-1], total[1:-1, 1:])
    came = np.where(total[1:-1, :-1] <= total[1:-1, 1:], 1, 2)
    came[total[:-2, :-1] <= held + reluctance] = 0
    return came.transpose(2, 0, 1)


def rising(times: FloatArray) -> FloatArray:
    """`times` (..., m) made to rise by SLOWEST at least from one to the next, from about their
    first to about their last, within 0 .. m - 1."""
    last = times.shape[-1] - 1
    steps = np.cumsum(np.maximum(np.diff(times, axis=-1), SLOWEST), axis=-1)
    share = np.concatenate([np.zeros((*times.shape[:-1], 1)), steps / steps[..., -1:]], axis=-1)
    first = np.clip(times[..., :1], 0, last - 1)
    end = np.clip(times[..., -1:], first + 1, last)
    return np.asarray(first + share * (end - first))


def read_at(motions: FloatArray, times: FloatArray) -> FloatArray:
    """(n, m, d) `motions` (n, m, d) at `times` (n, m), in moments, on a cubic curve with
    Catmull-Rom tangents, as motion.resampling reads one."""
    last = motions.shape[1] - 1
    before = np.clip(np.floor(times).astype(np.int64), 0, last - 1)
    x = (times - before)[..., None]
    row = np.arange(len(motions))[:, None]
    a, b, c, d = (motions[row, np.clip(before + k, 0, last)] for k in (-1, 0, 1, 2))
    # beyond an end the curve goes straight on
    a = np.where((before == 0)[..., None], 2 * b - c, a)
    d = np.where((before == last - 1)[..., None], 2 * c - b, d)
    bend = 2 * a - 5 * b + 4 * c - d + x * (3 * (b - c) + d - a)
    return np.asarray(b + 0.5 * x * (c - a + x * bend))


def inverse(times: FloatArray) -> FloatArray:
    """(n, m) the times at which rising `times` (n, m) reach 0, 1, ... m - 1."""
    moments = np.arange(times.shape[1], dtype=np.float64)
    return np.stack([np.interp(moments, row, moments) for row in times])
