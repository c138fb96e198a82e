"""Tracks a drifting beat in any curve that is high where beats may be.

It finds the periods with which a curve repeats, and the beats of about such a period that collect
most of the curve (Ellis 2007, "Beat tracking by dynamic programming"). For recordings the curve is
their onset strength, for motions their stops.
"""

from __future__ import annotations

import math

import numpy as np
import scipy

from app.numerics.arrays import FloatArray, IntArray

MIN_BEATS = 4
"""The fewest beats of a rhythm."""

RATIOS = (1 / 3, 1 / 2, 2 / 3, 1.0, 3 / 2, 2.0, 3.0)
"""Ratios of tempi that share many beats. A strong period may be any of them times the beat."""

STEP = 0.005
"""The relative step of the grid of periods."""

APART = 0.04
"""The smallest relative difference of two periods that are both tried."""

MULTIPLES = 4
"""A curve must repeat after 1 to this many beats."""


def autocorrelation(strength: FloatArray) -> FloatArray:
    """(n,) the autocorrelation of `strength` (n,) by lag in frames, 1 at lag 0.

    It is corrected for the smaller overlap at large lags. A constant curve gives zeros.
    """
    count = len(strength)
    if not count or not np.ptp(strength) > 0:
        return np.zeros(count)
    length = scipy.fft.next_fast_len(2 * count, real=True)
    spectrum = scipy.fft.rfft(strength - strength.mean(), length)
    raw = scipy.fft.irfft(np.square(np.abs(spectrum)), length)[:count]
    overlap = np.maximum(count - np.arange(count), count / 4) / count
    return np.asarray(raw / raw[0] / overlap)


def likely_periods(
    strength: FloatArray, shortest: float, longest: float, count: int
) -> list[float]:
    """The lengths, in frames, that a beat may have, from `shortest` to `longest`.

    These are the `count` strongest periods of `strength` (n,) and their RATIOS, without those
    that are nearly equal.
    """
    longest = min(longest, len(strength) / MIN_BEATS)
    if longest <= shortest:
        return []
    grid = np.exp(np.arange(np.log(shortest / 1.5), np.log(longest), STEP))
    salience = _salience(autocorrelation(strength), grid)
    inner = (salience[1:-1] > salience[:-2]) & (salience[1:-1] >= salience[2:])
    peaks = np.flatnonzero(inner) + 1
    best = grid[peaks[np.argsort(-salience[peaks], kind="stable")][:count]]
    found: list[float] = []
    for period in (float(p / ratio) for p in best for ratio in RATIOS):
        new = all(abs(math.log(period / other)) > APART for other in found)
        if new and shortest <= period <= longest:
            found.append(period)
    return found


def _salience(correlation: FloatArray, periods: FloatArray) -> FloatArray:
    lags = np.arange(len(correlation))
    at = [np.interp(m * periods, lags, correlation, right=0.0) for m in range(1, MULTIPLES + 1)]
    return np.asarray(np.mean(at, axis=0))


def track(strength: FloatArray, period: float, tightness: float, reach: float = 2.0) -> IntArray:
    """The frames of the beats with intervals of about `period` frames that collect most strength.

    strength: (n,). tightness: the weight of the squared logarithm of interval / period. reach:
    the largest factor between them. Blocks as long as the shortest interval are computed at once,
    because the predecessor of a beat is always in an earlier block.
    """
    nearest, furthest = max(1, round(period / reach)), max(2, round(reach * period))
    gaps = np.arange(furthest, nearest - 1, -1)
    cost = -tightness * np.square(np.log(gaps / period))
    count = len(strength)
    if not count:
        return np.zeros(0, dtype=np.int64)
    # Row f of `behind` holds `total` of the frames f - furthest .. f - nearest.
    total = np.concatenate([np.full(furthest, -np.inf), strength])
    # numpy's sliding_window_view takes longer than a step of the loop below.
    behind = np.ndarray((len(total) - len(gaps) + 1, len(gaps)), buffer=total, strides=(8, 8))
    for first in range(nearest, count, nearest):
        stop = min(first + nearest, count)
        reached = np.maximum.reduce(behind[first:stop] + cost, axis=1)
        here = total[furthest + first : furthest + stop]
        np.add(here, np.maximum(reached, 0.0, out=reached), out=here)
    last = max(0, count - round(period))
    beats = [last + int(total[furthest + last :].argmax())]
    while beats[-1] >= nearest:
        reached = (behind[beats[-1]] + cost)[::-1]
        best = int(reached.argmax())
        if not reached[best] > 0:
            break
        beats.append(beats[-1] - nearest - best)
    return np.array(beats[::-1], dtype=np.int64)
