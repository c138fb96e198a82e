"""Following a beat that drifts, in any curve that is high where beats may be.

Which periods a curve repeats with, and the frames of the beats of about such a period that
gather most of the curve (Ellis 2007, "Beat tracking by dynamic programming"). Recordings are
followed by their onsets, motions by their stops.
"""

from __future__ import annotations

import numpy as np
import scipy
from numpy.lib.stride_tricks import sliding_window_view

from app.numerics.arrays import FloatArray, IntArray

MIN_BEATS = 4
"""Fewer are no rhythm."""

RATIOS = (1 / 3, 1 / 2, 2 / 3, 1.0, 3 / 2, 2.0, 3.0)
"""Tempi that share most of their beats: what a curve repeats with may be any of them."""

STEP = 0.005
"""Relative step of the grid of periods."""

APART = 0.04
"""Relative difference of periods that are tried for themselves."""

MULTIPLES = 4
"""Beats after which a curve must repeat."""


def autocorrelation(strength: FloatArray) -> FloatArray:
    """(n,) by lag in frames, 1 at lag 0, not falling with the overlap; zeros if constant."""
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
    """Frames that a beat may last: the `count` strongest periods and their ratios, each once."""
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
        new = all(abs(np.log(period / other)) > APART for other in found)
        if new and shortest <= period <= longest:
            found.append(period)
    return found


def _salience(correlation: FloatArray, periods: FloatArray) -> FloatArray:
    lags = np.arange(len(correlation))
    at = [np.interp(m * periods, lags, correlation, right=0.0) for m in range(1, MULTIPLES + 1)]
    return np.asarray(np.mean(at, axis=0))


def track(strength: FloatArray, period: float, tightness: float, reach: float = 2.0) -> IntArray:
    """Frames of the beats of about `period` frames that gather most `strength` (n,).

    tightness: weight of the squared logarithm of an interval over the period; reach: factor
    by which an interval may differ from it. Whole blocks of the shortest interval are filled
    at once: a beat's predecessor lies in an earlier block.
    """
    nearest, furthest = max(1, round(period / reach)), max(2, round(reach * period))
    gaps = np.arange(furthest, nearest - 1, -1)
    cost = -tightness * np.square(np.log(gaps / period))
    count = len(strength)
    if not count:
        return np.zeros(0, dtype=np.int64)
    # Row f of `behind` sees `total` of frames f - furthest .. f - nearest.
    total = np.concatenate([np.full(furthest, -np.inf), strength])
    behind = sliding_window_view(total, len(gaps))
    for first in range(nearest, count, nearest):
        reached = (behind[first : min(first + nearest, count)] + cost).max(axis=1)
        here = total[furthest + first : furthest + first + len(reached)]
        here += np.maximum(reached, 0.0)
    last = max(0, count - round(period))
    beats = [last + int(total[furthest + last :].argmax())]
    while beats[-1] >= nearest:
        reached = (behind[beats[-1]] + cost)[::-1]
        best = int(reached.argmax())
        if not reached[best] > 0:
            break
        beats.append(beats[-1] - nearest - best)
    return np.array(beats[::-1], dtype=np.int64)
