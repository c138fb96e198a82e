"""Motions of one task brought to one course of time, and back.

Of takes that do not go round one begins late and another lingers: their mean as they are would
be half a gesture twice. Each is warped onto the mean of its group; how its time runs beside
that of the group is kept as its *timing*, which is learned and carried over as the rest of a
motion is. Cycles are aligned where they are cut.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from app.analysis.motion_sample import SAMPLES
from app.analysis.motion_shape import CHANNELS
from app.models.synthesis_basis import weights
from app.models.synthesis_warping import inverse, read_at, rising, warping_times
from app.numerics.arrays import BoolArray, FloatArray, IntArray

ROUNDS = 2
"""Of warping onto the mean and taking the mean of what was warped."""

_TIE = 1e-6
"""Relative: distances this close count as equal, rounding must not decide."""

_STEADY: FloatArray = np.arange(SAMPLES, dtype=np.float64)


@dataclass(frozen=True, slots=True)
class Timed:
    """shapes: (n, 1378) motion shapes in the time of their group; timing: (n, 32) moments by
    which each is late in its own time, zeros for what goes round or is alone."""

    shapes: FloatArray
    timing: FloatArray


def together(shapes: FloatArray, group: IntArray) -> Timed:
    """Motion shapes (n, 1378) in the mean time of those of the same number in `group` (n,).

    Groups in which anything goes round stay as they are.
    """
    shapes = np.array(shapes, dtype=np.float64)
    timing = np.zeros((len(shapes), SAMPLES))
    chosen = np.flatnonzero(_can_be_warped(shapes, group))
    if not len(chosen):
        return Timed(shapes, timing)
    moments = moments_of_shapes(shapes[chosen])
    group = np.unique(group[chosen], return_inverse=True)[1]
    times: FloatArray = _STEADY
    reference = moments[_medoids(moments, group)]
    for _ in range(ROUNDS):
        times = warping_times(_compared(moments), _compared(reference)[group])
        reference = _means(read_at(moments, times), group)
    # the time of the group is the mean of its members'
    usual = inverse(rising(_means(times, group)))[group]
    times = rising(read_at(times[:, :, None], usual)[:, :, 0])
    shapes[chosen, :-2] = read_at(moments, times).reshape(len(chosen), -1)
    timing[chosen] = times - _STEADY
    return Timed(shapes, timing)


def onto(shapes: FloatArray, references: FloatArray, smoothing: float = 0.0) -> Timed:
    """Each of `shapes` (n, 1378) in the time of the same row of `references` (n, 1378); what
    goes round, and what is held against something that does, stays as it is.

    smoothing: moments (standard deviation) within which time is not to hurry and linger, beyond
    what `warping_times` smooths.
    """
    shapes = np.array(shapes, dtype=np.float64)
    timing = np.zeros((len(shapes), SAMPLES))
    chosen = np.flatnonzero((shapes[:, -1] < 0.5) & (references[:, -1] == 0.0))
    if len(chosen):
        moments = moments_of_shapes(shapes[chosen])
        aims = moments_of_shapes(references[chosen])
        times = warping_times(_compared(moments), _compared(aims))
        if smoothing > 0:
            moved = scipy.ndimage.gaussian_filter1d(
                times - _STEADY, smoothing, axis=1, mode="nearest"
            )
            times = rising(moved + _STEADY)
        shapes[chosen, :-2] = read_at(moments, times).reshape(len(chosen), -1)
        timing[chosen] = times - _STEADY
    return Timed(shapes, timing)


def in_own_time(shape: FloatArray, timing: FloatArray) -> FloatArray:
    """(1378,) a shape that is in the time of its group, with its own `timing` (32,)."""
    times = inverse(rising(_STEADY + timing)[None])
    moments = read_at(moments_of_shapes(shape[None]), times)
    return np.concatenate([moments.ravel(), shape[-2:]])


def moments_of_shapes(shapes: FloatArray) -> FloatArray:
    """(n, 32, 43) of motion shapes (n, 1378)."""
    return np.asarray(shapes[:, :-2]).reshape(len(shapes), SAMPLES, CHANNELS)


def _can_be_warped(shapes: FloatArray, group: IntArray) -> BoolArray:
    """(n,) which are in a group of several of which none goes round."""
    count = np.bincount(group)
    cyclic = np.bincount(group, weights=shapes[:, -1] >= 0.5)
    return np.asarray(((count > 1) & (cyclic == 0))[group])


def _compared(moments: FloatArray) -> FloatArray:
    """What tells which moment is which: the movement, whatever the posture."""
    weighed = moments * weights()[:CHANNELS]
    return np.asarray(weighed - weighed.mean(axis=1, keepdims=True))


def _medoids(moments: FloatArray, group: IntArray) -> IntArray:
    """(groups,) the row nearest to all others of its group."""
    rows = _compared(moments).reshape(len(moments), -1)
    return np.array([members[medoid(rows[members])] for members in _members(group)])


def medoid(rows: FloatArray) -> int:
    """Which of `rows` (n, d) is nearest to all the others, the first where several are."""
    gram = rows @ rows.T
    squares = np.diag(gram)[:, None] + np.diag(gram) - 2 * gram
    away = np.sqrt(np.maximum(squares, 0.0)).sum(axis=1)
    return int(np.argmax(away <= (1 + _TIE) * away.min()))  # of two, both are: rounding apart


def _members(group: IntArray) -> list[IntArray]:
    order = np.argsort(group, kind="stable")
    return list(np.split(order, np.cumsum(np.bincount(group))[:-1]))


def _means(values: FloatArray, group: IntArray) -> FloatArray:
    """(groups, ...) of `values` (n, ...)."""
    return np.stack([values[members].mean(axis=0) for members in _members(group)])
