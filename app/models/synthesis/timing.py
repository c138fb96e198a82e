"""Warps motion shapes to the time of their group, and back to their own time.

Takes that are not cycles begin at different times and have different speeds. Without alignment,
their mean would show half a gesture twice. Each take is warped onto the mean of its group
(app.numerics.alignment.group_warping). The difference between its time and that of the group is its
*timing*. It is learned and predicted like the rest of a motion. Cycles are aligned where
they are cut, so they are not warped.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.analysis.descriptors.motion_sample import SAMPLES
from app.analysis.descriptors.motion_shape import CHANNELS
from app.models.synthesis.basis import weights
from app.numerics.alignment.group_warping import (
    ROUNDS,
    group_means,
    group_members,
    inverse,
    means_of_warped,
    read_at,
    rising,
    smooth_times,
    warping_times,
)
from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.numerics.euclidean import distances

_TIE = 1e-6
"""Distances count as equal up to this relative difference, so that rounding does not decide."""

_STEADY: FloatArray = np.arange(SAMPLES, dtype=np.float64)
"""The times of a motion without a delay, in moments."""


@dataclass(frozen=True, slots=True)
class Timed:
    """Motion shapes in the time of their group.

    shapes: (n, 1378). timing: (n, 32) for each moment of the group's time, the time in the take
    itself minus the time of the group, in moments; zeros for cycles and for single takes.
    """

    shapes: FloatArray
    timing: FloatArray


def warp_to_groups(shapes: FloatArray, group: IntArray) -> Timed:
    """Warp motion shapes (n, 1378) to the mean time of their group; group: (n,) its number.

    Groups that contain a cycle stay as they are.
    """
    shapes = np.array(shapes, dtype=np.float64)
    timing = np.zeros((len(shapes), SAMPLES))
    chosen = np.flatnonzero(_can_be_warped(shapes, group))
    if not len(chosen):
        return Timed(shapes, timing)
    moments = moments_of_shapes(shapes[chosen])
    group = np.unique(group[chosen], return_inverse=True)[1]
    medoids = moments[_medoids(moments, group)]
    # The last round is not part of this call: only its times are needed.
    means = means_of_warped(moments, group, medoids, _by_movement, ROUNDS - 1)
    times = _times(moments, means[group])
    # the time of a group is the mean time of its members
    usual = inverse(rising(group_means(times, group)))[group]
    times = rising(read_at(times[:, :, None], usual)[:, :, 0])
    shapes[chosen, :-2] = read_at(moments, times).reshape(len(chosen), -1)
    timing[chosen] = times - _STEADY
    return Timed(shapes, timing)


def warp_to_references(shapes: FloatArray, references: FloatArray, smoothing: float = 0.0) -> Timed:
    """Warp each of `shapes` (n, 1378) to the time of the same row of `references` (n, 1378).

    A cycle stays as it is, and so does a shape whose reference is a cycle. smoothing: standard
    deviation, in moments, by which times are smoothed beyond what `warping_times` smooths.
    """
    shapes = np.array(shapes, dtype=np.float64)
    timing = np.zeros((len(shapes), SAMPLES))
    chosen = np.flatnonzero((shapes[:, -1] < 0.5) & (references[:, -1] == 0.0))
    if len(chosen):
        moments = moments_of_shapes(shapes[chosen])
        targets = moments_of_shapes(references[chosen])
        times = _times(moments, targets)
        if smoothing > 0:
            times = smooth_times(times, smoothing)
        shapes[chosen, :-2] = read_at(moments, times).reshape(len(chosen), -1)
        timing[chosen] = times - _STEADY
    return Timed(shapes, timing)


def to_own_time(shape: FloatArray, timing: FloatArray) -> FloatArray:
    """(1378,) a `shape` (1378,) in the time of its group, warped to its own `timing` (32,)."""
    times = inverse(rising(_STEADY + timing)[None])
    moments = read_at(moments_of_shapes(shape[None]), times)
    return np.concatenate([moments.ravel(), shape[-2:]])


def moments_of_shapes(shapes: FloatArray) -> FloatArray:
    """(n, 32, 43) of motion shapes (n, 1378)."""
    return np.asarray(shapes[:, :-2]).reshape(len(shapes), SAMPLES, CHANNELS)


def _can_be_warped(shapes: FloatArray, group: IntArray) -> BoolArray:
    """(n,) whether each shape is in a group of several takes without a cycle."""
    count = np.bincount(group)
    cyclic = np.bincount(group, weights=shapes[:, -1] >= 0.5)
    return np.asarray(((count > 1) & (cyclic == 0))[group])


def _times(moments: FloatArray, references: FloatArray) -> FloatArray:
    """(n, 32) the time in `moments` of each moment of the `references`, both (n, 32, 43)."""
    return warping_times(_compared(moments), _compared(references))


def _by_movement(moments: FloatArray, references: FloatArray) -> FloatArray:
    """(n, 32, 43) `moments` at the times that correspond to the moments of `references`."""
    return read_at(moments, _times(moments, references))


def _compared(moments: FloatArray) -> FloatArray:
    """(n, 32, 43) the weighted movement without the mean posture, by which moments are compared."""
    weighted = moments * weights()[:CHANNELS]
    return np.asarray(weighted - weighted.mean(axis=1, keepdims=True))


def _medoids(moments: FloatArray, group: IntArray) -> IntArray:
    """(groups,) the row nearest to all others of its group."""
    rows = _compared(moments).reshape(len(moments), -1)
    return np.array([members[medoid(rows[members])] for members in group_members(group)])


def medoid(rows: FloatArray) -> int:
    """The index of the row of `rows` (n, d) with the smallest sum of distances to all others.

    Among equally good rows, it is the first one.
    """
    totals = distances(rows, rows).sum(axis=1)
    return int(np.argmax(totals <= (1 + _TIE) * totals.min()))  # of two rows, both are the medoid
