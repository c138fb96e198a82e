"""Takes warped onto the mean of their group, by dynamic time warping.

Of two takes of a task, one hurries where the other is slow, so that moments of the same number
are not the same moment of the task. A mean of the takes as they are is blurred, and a difference
in timing looks like a difference in manner. So each take is warped onto the mean of its group, and
the mean is taken again. Recognition needs the warped takes alone (`warped`). Synthesis brings its
results back to a time of their own, so it needs times that rise smoothly and may lie between
moments (`warping_times`, `read_at`, `inverse`).

Shapes: motions (n, m, d) are n takes of m moments of d numbers. A time is a number of moments.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy

from app.numerics.alignment.dtw_path import cheapest_paths
from app.numerics.arrays import FloatArray, IntArray
from app.numerics.euclidean import distances

BAND = 0.2
"""The share of its length by which a moment may be moved."""

STEP_COST = 0.1
"""The cost of a step of one sequence alone, as a share of the mean distance of two moments."""

ROUNDS = 2
"""How often takes are warped onto the mean, and the mean is taken of what was warped."""

SMOOTHING = 1.0
"""Standard deviation in moments: a path goes by whole steps, but time does not."""

SLOWEST = 0.2
"""Moments of a take that pass at least in one moment of the reference: time never stands still."""

AT_ONCE = 2000
"""Takes whose tables are in memory together: about 100 MB with 32 moments."""

Warp = Callable[[FloatArray, FloatArray], FloatArray]
"""Takes (n, m, d) and a reference for each (n, m, d) to the warped takes (n, m, d)."""


def means_of_warped(
    motions: FloatArray, group: IntArray, references: FloatArray, warp: Warp, rounds: int = ROUNDS
) -> FloatArray:
    """(g, m, d) the mean of each group's takes, warped onto it `rounds` times.

    motions: (n, m, d); group: (n,) the number of each take's group, 0 .. g - 1, none empty;
    references: (g, m, d) onto which the takes of each group are warped first.
    """
    for _ in range(rounds):
        references = group_means(warp(motions, references[group]), group)
    return references


def group_means(values: FloatArray, group: IntArray) -> FloatArray:
    """(g, ...) the mean of `values` (n, ...) of each number in `group` (n,), 0 .. g - 1."""
    return np.stack([values[members].mean(axis=0) for members in group_members(group)])


def group_members(group: IntArray) -> list[IntArray]:
    """The rows of each number in `group` (n,), 0 .. g - 1, ascending."""
    order = np.argsort(group, kind="stable")
    return list(np.split(order, np.cumsum(np.bincount(group))[:-1]))


def warped(motions: FloatArray, references: FloatArray) -> FloatArray:
    """(n, m, d) `motions` (n, m, d) in the time of `references` (m, d) or (n, m, d).

    Each moment is the mean of those moments of the take that the cheapest path holds against
    that moment of the reference.
    """
    motions = np.asarray(motions, dtype=np.float64)
    references = np.broadcast_to(references, motions.shape)
    out = np.empty(motions.shape)
    for part in _parts(len(motions)):
        weights = _weights(motions[part], references[part])
        out[part] = np.einsum("nij,nid->njd", weights, motions[part])
    return out


def warping_times(motions: FloatArray, references: FloatArray) -> FloatArray:
    """(n, m) the time in each of `motions` (n, m, d) that goes with each moment of the reference
    in the same row of `references` (n, m, d). Times rise from moment to moment."""
    steady = np.arange(motions.shape[1], dtype=np.float64)
    held = np.empty(motions.shape[:2])
    for part in _parts(len(motions)):
        held[part] = np.einsum("nij,i->nj", _weights(motions[part], references[part]), steady)
    return smooth_times(held, SMOOTHING)


def smooth_times(times: FloatArray, deviation: float) -> FloatArray:
    """(n, m) rising times like `times` (n, m), of which the difference from steady time is
    smoothed by a Gaussian with the standard `deviation`, in moments."""
    steady = np.arange(times.shape[1], dtype=np.float64)
    moved = scipy.ndimage.gaussian_filter1d(times - steady, deviation, axis=1, mode="nearest")
    return rising(moved + steady)


def rising(times: FloatArray) -> FloatArray:
    """(..., m) `times` (..., m) changed so that each is later than the one before by SLOWEST at
    least, from about their first to about their last, all within 0 .. m - 1."""
    last = times.shape[-1] - 1
    steps = np.cumsum(np.maximum(np.diff(times, axis=-1), SLOWEST), axis=-1)
    share = np.concatenate([np.zeros((*times.shape[:-1], 1)), steps / steps[..., -1:]], axis=-1)
    first = np.clip(times[..., :1], 0, last - 1)
    end = np.clip(times[..., -1:], first + 1, last)
    return np.asarray(first + share * (end - first))


def inverse(times: FloatArray) -> FloatArray:
    """(n, m) the times at which the rising `times` (n, m) reach 0, 1, ... m - 1."""
    moments = np.arange(times.shape[1], dtype=np.float64)
    return np.stack([np.interp(moments, row, moments) for row in times])


def read_at(motions: FloatArray, times: FloatArray) -> FloatArray:
    """(n, m, d) the values of `motions` (n, m, d) at their own `times` (n, m).

    Between moments a motion is a cubic curve with Catmull-Rom tangents, as in
    `app.motion.skeleton.resampling`, which reads one motion.
    """
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


def _parts(count: int) -> list[slice]:
    return [slice(first, first + AT_ONCE) for first in range(0, count, AT_ONCE)]


def _weights(motions: FloatArray, references: FloatArray) -> FloatArray:
    """(n, m, m) how much moment i of a take counts at moment j of its reference; over i, the
    weights sum to 1. motions, references: (n, m, d)."""
    cost = distances(motions, references)
    path = cheapest_paths(cost, BAND, STEP_COST * cost.mean(axis=(1, 2)))
    return np.asarray(path / path.sum(axis=1, keepdims=True))
