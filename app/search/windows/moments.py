"""Moments: the parts of clips in which something is probable, from probabilities of windows.

Windows of several lengths say how probable something is around their middles. `on_grid` makes a
curve over time of them, for each clip. A moment is a peak of the curve and what is around it as
long as it stays above a share of the peak (RELATIVE). Its score is the mean of the curve.

The source is our own. On real clips joined end to end, half of the clips to choose and half to
report (`tests/bench/test_moments.py`): a share of the peak is better than a fixed threshold, and
than the parts with the largest sum of log odds.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from app.deadline import check
from app.numerics.arrays import FloatArray, IntArray
from app.search.ranking.ranking import DECIMALS, IdArray
from app.search.windows.overlap_merging import FoundInterval

STEP = 0.25
"""Seconds between two points of a curve."""
RELATIVE = 0.3
"""A moment is as long as its curve stays above this share of its peak."""
MAX_IN_CLIP = 1000
"""The most moments of one clip."""
SMALLEST = 1e-6
"""Scores below it count as it, so that distances are finite."""


@dataclass(frozen=True, slots=True)
class Curves:
    """Curves of c clips, one after the other.

    ids: (c,); firsts: (c + 1,) the first point of each clip, and the number of all points;
    seconds: (c,) the lengths; values: (points,) 0..1. A point is the middle of a step, or the end
    of the clip if the clip ends before the middle of its last step.
    """

    ids: IdArray
    firsts: IntArray
    seconds: FloatArray
    values: FloatArray

    def means(self, owners: IntArray, starts: FloatArray, ends: FloatArray) -> FloatArray:
        """(k,) the mean of the curve over parts of clips, by the numbers `owners` (k,) and times
        in seconds (k,). A part counts every step that it touches."""
        sums = np.concatenate([[0.0], np.cumsum(self.values)])
        lasts = self.firsts[owners + 1]
        first = np.minimum(self.firsts[owners] + (starts / STEP).astype(np.int64), lasts - 1)
        stop = np.clip(
            self.firsts[owners] + np.ceil(ends / STEP).astype(np.int64), first + 1, lasts
        )
        return np.asarray((sums[stop] - sums[first]) / (stop - first))


def on_grid(
    ids: IdArray, owners: IntArray, starts: FloatArray, ends: FloatArray, values: FloatArray
) -> Curves:
    """Curves from windows: each point is the mean over the lengths of windows; of each length, of
    the windows around the point, weighted by their nearness (a triangle).

    ids: (c,) of all clips; owners: (k,) ascending numbers of the windows' clips; starts, ends:
    (k,) seconds; values: (k,) 0..1.
    """
    numbers, own = np.unique(owners, return_inverse=True)
    seconds = np.zeros(len(numbers))
    np.maximum.at(seconds, own, ends)
    firsts = np.concatenate([[0], np.cumsum(np.maximum(np.ceil(seconds / STEP), 1))])
    firsts = firsts.astype(np.int64)
    total, count = np.zeros(firsts[-1]), np.zeros(firsts[-1])
    for length in np.unique(np.round((ends - starts) / STEP)):
        some = np.flatnonzero(np.round((ends - starts) / STEP) == length)
        mean, has = _of_one_length(
            firsts, seconds, own[some], starts[some], ends[some], values[some], int(length)
        )
        total, count = total + mean, count + has
    return Curves(ids[numbers], firsts, seconds, total / np.maximum(count, 1))


def _of_one_length(
    firsts: IntArray,
    seconds: FloatArray,
    own: IntArray,
    starts: FloatArray,
    ends: FloatArray,
    values: FloatArray,
    steps: int,
) -> tuple[FloatArray, FloatArray]:
    """(points,) weighted means of windows of one length, 0 where there is none; and (points,) 1
    where there is one."""
    weighted, weights = np.zeros(firsts[-1]), np.zeros(firsts[-1])
    middles, half = (starts + ends) / 2, np.maximum((ends - starts) / 2, STEP / 2)
    begin = (starts / STEP).astype(np.int64)
    for step in range(max(steps, 1) + 1):
        at = np.minimum((begin + step + 0.5) * STEP, seconds[own])
        inside = (at >= starts) & (at <= ends) & (firsts[own] + begin + step < firsts[own + 1])
        points = (firsts[own] + begin + step)[inside]
        near = np.maximum(1.0 - np.abs(at - middles) / half, 1e-3)[inside]
        weighted += np.bincount(points, near * values[inside], len(weighted))
        weights += np.bincount(points, near, len(weights))
    return weighted / np.maximum(weights, 1e-12), (weights > 0.0).astype(np.float64)


def nearest_moments(curves: Curves) -> Iterator[FoundInterval]:
    """All moments of all clips, the most probable first. distance: -ln of the score.

    Clips are taken by their highest point. No moment of a later clip has a higher score, so a page
    of results needs only a few clips.
    """
    peaks = np.zeros(0)
    if len(curves.ids):
        peaks = np.maximum.reduceat(curves.values, curves.firsts[:-1])
    waiting: list[tuple[float, str, FoundInterval]] = []
    for number in np.argsort(-peaks, kind="stable").tolist():
        check()
        bound = _distance(float(peaks[number]))
        while waiting and waiting[0][0] < bound:
            yield heapq.heappop(waiting)[2]
        for found in _moments(curves, number):
            heapq.heappush(waiting, (found.distance, found.key, found))
    while waiting:
        yield heapq.heappop(waiting)[2]


def _moments(curves: Curves, number: int) -> Iterator[FoundInterval]:
    """The moments of a clip."""
    values = curves.values[curves.firsts[number] : curves.firsts[number + 1]]
    for first, stop in peaks_of(values):
        end = min(stop * STEP, float(curves.seconds[number]))
        distance = _distance(float(values[first:stop].mean()))
        yield FoundInterval(str(curves.ids[number]), first * STEP, end, distance, number)


def peaks_of(values: FloatArray) -> list[tuple[int, int]]:
    """The moments of a curve (n,): first point, and the point after the last; they do not touch.

    The highest peak comes first, then the highest peak of the rest, and so on.
    """
    rest = np.where(values > SMALLEST, values, 0.0)
    found: list[tuple[int, int]] = []
    while len(found) < MAX_IN_CLIP and rest.max(initial=0.0) > 0.0:
        peak = int(np.argmax(rest))
        low = rest < RELATIVE * rest[peak]
        before, after = np.flatnonzero(low[:peak]), np.flatnonzero(low[peak:])
        first = int(before[-1]) + 1 if len(before) else 0
        stop = peak + int(after[0]) if len(after) else len(values)
        found.append((first, stop))
        # The points beside a moment are the slopes of the same peak.
        rest[max(first - 1, 0) : stop + 1] = 0.0
    return found


def _distance(score: float) -> float:
    return round(-float(np.log(max(score, SMALLEST))), DECIMALS)
