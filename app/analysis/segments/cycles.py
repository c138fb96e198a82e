"""Cycles: sequences of segments that are danced again and again.

A cycle begins and ends at keyposes, and a similar one follows it. Two parts are compared at
equally many, evenly spaced times. So the tempo does not matter, and a missed keypose within a part
does no harm. Their similarity is Lin's concordance (1989): 1 minus the mean squared
distance divided by the sum of both variances. So a body that stands still or shakes has no
cycles.

Of all runs of such parts, the one with the largest sum of duration times concordance is taken
first; its first cycle does not count. So two steps danced four times are four cycles, not two
cycles of four steps. Then the next run is taken from the rest of the motion.
"""

from __future__ import annotations

from dataclasses import dataclass
from heapq import heapify, heappop, heappush
from itertools import pairwise

import numpy as np

from app.numerics.arrays import FloatArray

MAX_SEGMENTS = 32
"""The most segments of a cycle."""

SAMPLES = 32
"""The number of times at which two parts are compared."""

MIN_CONCORDANCE = 0.6
"""The smallest concordance of two cycles. It is 1 for equal ones, 0 if they have nothing in
common."""

MAX_STRETCH = 1.3
"""The largest ratio of the durations of a cycle and the next one."""

MAX_LENGTH_DIFFERENCE = 1
"""The largest difference of the numbers of segments of a cycle and the next one. It allows for a
missed keypose."""

_MIN_VARIANCE = 1e-6
"""Squared body lengths: smaller variances are only rounding errors."""


@dataclass(frozen=True, slots=True)
class Cycle:
    """One repetition: the segments first .. stop - 1.

    run: the number of the repeated sequence to which it belongs, from 0, in order of time.
    """

    first: int
    stop: int
    run: int


def find_cycles(poses: FloatArray, bounds: FloatArray) -> tuple[Cycle, ...]:
    """The cycles of a motion in order of time; each run has at least two.

    poses: (n, d) in the body frame, body lengths. bounds: (m + 1,) the rising times of the
    keyposes between m segments, in frames.
    """
    if len(bounds) < 3 or len(poses) < 2:
        return ()
    links = _links(poses.astype(np.float32), bounds)
    return tuple(
        Cycle(first, stop, number)
        for number, run in enumerate(sorted(_runs(links, bounds)))
        for first, stop in pairwise(run)
    )


_Part = tuple[int, int]
"""A first segment and a number of segments."""


@dataclass(frozen=True, slots=True)
class _Link:
    """A link from a part to the most similar part that follows it directly.

    length: the number of segments of that part. score: its duration times its concordance.
    """

    length: int
    score: float


def _links(poses: FloatArray, bounds: FloatArray) -> dict[_Part, _Link]:
    """The link of each part that has one."""
    longest = min(MAX_SEGMENTS, len(bounds) - 2)
    links: dict[_Part, _Link] = {}
    near: dict[int, _Parts] = {}
    for length in range(1, longest + 1):
        others = range(
            max(length - MAX_LENGTH_DIFFERENCE, 1), min(length + MAX_LENGTH_DIFFERENCE, longest) + 1
        )
        # only parts of about this length are kept in memory, because all together are large
        near = {other: near.get(other) or _Parts(poses, bounds, other) for other in others}
        best = np.full(len(bounds), MIN_CONCORDANCE)
        for other in others:
            concordance = near[length].concordance(near[other])
            for first in np.flatnonzero(concordance > best[: len(concordance)]):
                best[first] = concordance[first]
                duration = near[other].durations[first + length]
                links[int(first), length] = _Link(other, float(duration * concordance[first]))
    return links


class _Parts:
    """All parts of `length` segments: their poses (c, SAMPLES, d), durations and variances."""

    def __init__(self, poses: FloatArray, bounds: FloatArray, length: int) -> None:
        self.length = length
        starts, ends = bounds[:-length], bounds[length:]
        at = starts[:, None] + (ends - starts)[:, None] * np.linspace(0.0, 1.0, SAMPLES)
        # (c, SAMPLES) times in frames; linear interpolation between the two nearest poses
        at = np.clip(at, 0, len(poses) - 1)
        left = np.minimum(at.astype(np.int64), len(poses) - 2)
        share = (at - left).astype(np.float32)[..., None]
        self.poses = poses[left] * (1 - share) + poses[left + 1] * share
        self.durations = ends - starts
        self.variances = _mean_squares(self.poses - self.poses.mean(axis=1, keepdims=True))

    def concordance(self, other: _Parts) -> FloatArray:
        """(c,) the concordance of each part with the part of `other` that follows it.

        It is -1 if their durations differ too much, or if nothing moves.
        """
        count = max(len(other.poses) - self.length, 0)
        one, two = slice(0, count), slice(self.length, self.length + count)
        apart = _mean_squares(self.poses[one] - other.poses[two])
        variances = self.variances[one] + other.variances[two]
        stretch = other.durations[two] / self.durations[one]
        near = (stretch <= MAX_STRETCH) & (stretch >= 1 / MAX_STRETCH) & (variances > _MIN_VARIANCE)
        return np.where(near, 1 - apart / np.maximum(variances, _MIN_VARIANCE), -1.0)


def _mean_squares(lines: FloatArray) -> FloatArray:
    """(c,) the mean squared length, over samples, of `lines` (c, SAMPLES, d)."""
    return np.asarray(np.einsum("csd,csd->c", lines, lines)) / SAMPLES


def _runs(links: dict[_Part, _Link], bounds: FloatArray) -> list[list[int]]:
    """The bounds of the cycles of each run, the run of the largest score first.

    No two runs share a segment.
    """
    # of two runs of equal score, the earlier one, then the one with shorter cycles comes first
    queue = [(-score, *part, end) for part, (score, end) in _ends(links).items()]
    heapify(queue)
    taken = np.zeros(len(bounds) - 1, dtype=bool)
    runs: list[list[int]] = []
    while queue:
        _, first, length, end = heappop(queue)
        if taken[first]:
            continue
        blocked = np.flatnonzero(taken[first:end])
        last_bound = first + int(blocked[0]) if len(blocked) else end
        score, run = _run_from(links, (first, length), last_bound)
        if run[-1] == end:
            taken[first:end] = True
            runs.append(run)
        elif len(run) > 2:
            heappush(queue, (-score, first, length, run[-1]))
    return runs


def _ends(links: dict[_Part, _Link]) -> dict[_Part, tuple[float, int]]:
    """For each part, the score of the run that begins with it, and the bound where it ends."""
    ends: dict[_Part, tuple[float, int]] = {}
    for part in sorted(links, reverse=True):
        link, first = links[part], sum(part)
        score, end = ends.get((first, link.length), (0.0, first + link.length))
        ends[part] = link.score + score, end
    return ends


def _run_from(links: dict[_Part, _Link], part: _Part, last_bound: int) -> tuple[float, list[int]]:
    """The score of a run and the bounds of its cycles, up to the bound `last_bound`."""
    score, run = 0.0, [part[0], sum(part)]
    while link := links.get((run[-2], run[-1] - run[-2])):
        if run[-1] + link.length > last_bound:
            break
        score += link.score
        run.append(run[-1] + link.length)
    return score, run
