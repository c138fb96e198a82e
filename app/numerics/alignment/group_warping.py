"""Takes warped onto the mean of their group, by dynamic time warping.

Two takes of a task differ in timing: moment i of one take is not the same part of the task as
moment i of another. So a plain mean of the takes is blurred, and a difference in timing looks like
a difference in style. Therefore each take is warped onto the mean of its group, and the mean is
computed again. Recognition needs only the warped takes (`warped`). Synthesis gives its results a
timing of their own. It needs times that rise smoothly and may lie between moments
(`warping_times`, `read_at`, `inverse`).

Shapes: motions (n, m, d) are n takes of m moments of d numbers. A time is counted in moments.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy

from app.numerics.alignment.dtw_path import cheapest_paths
from app.numerics.arrays import FloatArray, IntArray
from app.numerics.euclidean import distances

BAND = 0.2
"""How far a moment may be moved, as a share of the length of a take."""

STEP_COST = 0.1
"""The cost of a step in one sequence alone, as a share of the mean distance of two moments."""

ROUNDS = 2
"""How often the takes are warped onto the mean and the mean is computed again."""

SMOOTHING = 1.0
"""Standard deviation, in moments, of the smoothing of times. A path has only whole steps."""

MIN_TIME_STEP = 0.2
"""The smallest number of moments of a take in one moment of the reference. So time never stops."""

MAX_TAKES_AT_ONCE = 2000
"""The largest number of takes whose cost tables are in memory together: about 100 MB with 32
moments."""

Warp = Callable[[FloatArray, FloatArray], FloatArray]
"""A function of takes (n, m, d) and their references (n, m, d) to the warped takes (n, m, d)."""


def means_of_warped(
    motions: FloatArray, group: IntArray, references: FloatArray, warp: Warp, rounds: int = ROUNDS
) -> FloatArray:
    """(g, m, d) the mean of the takes of each group, after they were warped onto it.

    motions: (n, m, d). group: (n,) the group of each take, 0 .. g - 1, no group empty.
    references: (g, m, d) the motions onto which the takes are warped in the first round. warp:
    how takes are warped. rounds: how often the means are computed.
    """
    for _ in range(rounds):
        references = group_means(warp(motions, references[group]), group)
    return references


def group_means(values: FloatArray, group: IntArray) -> FloatArray:
    """(g, ...) the mean of `values` (n, ...) in each group; group: (n,), 0 .. g - 1, none empty."""
    return np.stack([values[members].mean(axis=0) for members in group_members(group)])


def group_members(group: IntArray) -> list[IntArray]:
    """The ascending rows of each of the g groups; group: (n,), 0 .. g - 1."""
    order = np.argsort(group, kind="stable")
    return list(np.split(order, np.cumsum(np.bincount(group))[:-1]))


def warped(motions: FloatArray, references: FloatArray) -> FloatArray:
    """(n, m, d) `motions` (n, m, d) with the timing of `references` (m, d) or (n, m, d).

    Each moment is the mean of the moments of the take that the cheapest path matches with that
    moment of the reference.
    """
    motions = np.asarray(motions, dtype=np.float64)
    references = np.broadcast_to(references, motions.shape)
    out = np.empty(motions.shape)
    for part in _parts(len(motions)):
        weights = _weights(motions[part], references[part])
        # moment i of a take contributes to moment j of its reference: (n, m, m), (n, m, d)
        out[part] = np.einsum("nij,nid->njd", weights, motions[part])
    return out


def warping_times(motions: FloatArray, references: FloatArray) -> FloatArray:
    """(n, m) the time in each motion that belongs to each moment of its reference.

    motions, references: (n, m, d). The times rise strictly, within 0 .. m - 1.
    """
    steady = np.arange(motions.shape[1], dtype=np.float64)
    times = np.empty(motions.shape[:2])
    for part in _parts(len(motions)):
        times[part] = np.einsum("nij,i->nj", _weights(motions[part], references[part]), steady)
    return smooth_times(times, SMOOTHING)


def smooth_times(times: FloatArray, deviation: float) -> FloatArray:
    """(n, m) `times` (n, m) smoothed, and rising strictly.

    A Gaussian with the standard `deviation`, in moments, smooths their difference from the steady
    times 0, 1, ... m - 1.
    """
    steady = np.arange(times.shape[1], dtype=np.float64)
    moved = scipy.ndimage.gaussian_filter1d(times - steady, deviation, axis=1, mode="nearest")
    return rising(moved + steady)


def rising(times: FloatArray) -> FloatArray:
    """(..., m) `times` (..., m) changed so that they rise strictly within 0 .. m - 1.

    Smaller steps than MIN_TIME_STEP become MIN_TIME_STEP. Then all steps are scaled. So the first
    and the last time stay as they are (but are clipped to 0 .. m - 1).
    """
    last = times.shape[-1] - 1
    steps = np.cumsum(np.maximum(np.diff(times, axis=-1), MIN_TIME_STEP), axis=-1)
    share = np.concatenate([np.zeros((*times.shape[:-1], 1)), steps / steps[..., -1:]], axis=-1)
    first = np.clip(times[..., :1], 0, last - 1)
    end = np.clip(times[..., -1:], first + 1, last)
    return np.asarray(first + share * (end - first))


def inverse(times: FloatArray) -> FloatArray:
    """(n, m) the moments at which the rising `times` (n, m) reach 0, 1, ... m - 1."""
    moments = np.arange(times.shape[1], dtype=np.float64)
    return np.stack([np.interp(moments, row, moments) for row in times])


def read_at(motions: FloatArray, times: FloatArray) -> FloatArray:
    """(n, m, d) the values of each of `motions` (n, m, d), m >= 2, at its row of `times` (n, m).

    Between moments, a motion is a cubic curve with Catmull-Rom tangents, as in
    `app.motion.skeleton.resampling`, which reads one motion.
    """
    last = motions.shape[1] - 1
    before = np.clip(np.floor(times).astype(np.int64), 0, last - 1)
    x = (times - before)[..., None]
    row = np.arange(len(motions))[:, None]
    a, b, c, d = (motions[row, np.clip(before + k, 0, last)] for k in (-1, 0, 1, 2))
    # beyond its ends, the motion is continued as a straight line
    a = np.where((before == 0)[..., None], 2 * b - c, a)
    d = np.where((before == last - 1)[..., None], 2 * c - b, d)
    bend = 2 * a - 5 * b + 4 * c - d + x * (3 * (b - c) + d - a)
    return np.asarray(b + 0.5 * x * (c - a + x * bend))


def _parts(count: int) -> list[slice]:
    firsts = range(0, count, MAX_TAKES_AT_ONCE)
    return [slice(first, first + MAX_TAKES_AT_ONCE) for first in firsts]


def _weights(motions: FloatArray, references: FloatArray) -> FloatArray:
    """(n, m, m) the weight of moment i of a take in moment j of its reference.

    motions, references: (n, m, d). The weights sum to 1 over i.
    """
    cost = distances(motions, references)
    path = cheapest_paths(cost, BAND, STEP_COST * cost.mean(axis=(1, 2)))
    return np.asarray(path / path.sum(axis=1, keepdims=True))
