"""Proposals for a query: for each window, a likely interval of the query and its distance."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from app.analysis.descriptors.windows import WINDOW_SCALES, RunningSums, WindowScale
from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.search.windows.overlap_merging import Candidates
from app.search.windows.parts import Parts

MAX_WINDOWS = 16
"""Largest number of windows of a query. In a longer query, the steps between them are larger."""

WindowsAtScale = Callable[[WindowScale], Parts]
"""A function that returns the windows of one scale, of the clips that pass the filter."""


@dataclass(frozen=True, slots=True)
class QuerySegment:
    """The query: features (m, 82) at 10 Hz, and its duration in seconds."""

    features: FloatArray
    seconds: float


@dataclass(frozen=True, slots=True)
class ExcludedInterval:
    """A part of a clip, in seconds, in which no hit is allowed: the query itself."""

    clip_id: str
    start: float
    end: float


@dataclass(frozen=True, slots=True)
class Proposals:
    """For each of n windows the likely interval of the query, and its distance.

    starts, ends: (n,) seconds; distances: (n,); allowed: (k,) the windows that do not touch the
    excluded interval.
    """

    windows: Parts
    starts: FloatArray
    ends: FloatArray
    distances: FloatArray
    allowed: IntArray

    def candidates(self) -> Candidates:
        """The intervals of the allowed windows, in their order."""
        return Candidates(
            self.windows.ids,
            self.windows.owners[self.allowed],
            self.starts[self.allowed],
            self.ends[self.allowed],
            self.distances[self.allowed],
        )

    def distances_near(self, owners: IntArray, centers: FloatArray) -> FloatArray:
        """(k,) distances of the windows of clips `owners` (k,) nearest to times `centers` (k,)."""
        # One time axis for all clips, one after the other, so that one search serves all.
        max_length = float(self.ends.max(initial=0.0)) + 1.0
        times = self.windows.owners * max_length + (self.starts + self.ends) / 2
        targets = owners * max_length + centers
        after = np.searchsorted(times, targets)
        firsts = np.searchsorted(self.windows.owners, owners)
        lasts = np.searchsorted(self.windows.owners, owners, side="right") - 1
        left, right = np.clip(after - 1, firsts, lasts), np.clip(after, firsts, lasts)
        is_left = np.abs(times[left] - targets) <= np.abs(times[right] - targets)
        return np.asarray(self.distances[np.where(is_left, left, right)])


def scale_for(frames: int) -> WindowScale:
    """The longest windows that a query of `frames` frames at 10 Hz fills, else the shortest."""
    filled = [scale for scale in WINDOW_SCALES if scale.frames <= frames]
    return filled[-1] if filled else WINDOW_SCALES[0]


def propose(
    windows_at: WindowsAtScale, segment: QuerySegment, excluded: ExcludedInterval | None
) -> Proposals:
    """Compare a query with all windows of the scale that suits it.

    A query longer than a window is cut into windows too. Each of them is compared with the window
    of the clip at the same step. If the clip ends earlier, its last window is used instead.
    """
    scale = scale_for(len(segment.features))
    windows = windows_at(scale)
    steps = _steps(len(segment.features), scale)
    distances = windows.distances(_vectors(segment, scale, steps))
    lasts, numbers = windows.last_parts(), np.arange(len(windows))
    total = np.zeros(len(windows))
    for step, row in zip(steps, distances, strict=True):
        total += row[np.minimum(numbers + step, lasts)]
    starts, ends = _intervals(windows, segment.seconds, lasts, is_one=len(steps) == 1)
    allowed = np.flatnonzero(~_touching(windows, starts, ends, excluded))
    return Proposals(windows, starts, ends, total / len(steps), allowed)


def _steps(frames: int, scale: WindowScale) -> IntArray:
    """(q,) the hops from the start of the query to each of its windows.

    The windows are at least half a window apart.
    """
    last = round((frames - scale.frames) / scale.hop)
    if last <= 0:
        return np.zeros(1, dtype=np.int64)
    step = max(scale.frames // (2 * scale.hop), -(-last // (MAX_WINDOWS - 1)), 1)
    return np.unique(np.append(np.arange(0, last, step), last))


def _vectors(segment: QuerySegment, scale: WindowScale, steps: IntArray) -> FloatArray:
    """(q, d) float32 vectors of the query's windows; one window is the whole query."""
    frames = len(segment.features)
    firsts = np.minimum(steps * scale.hop, max(frames - scale.frames, 0))
    stops = firsts + scale.frames if len(steps) > 1 else np.array([frames])
    vectors = RunningSums(segment.features).vectors(np.stack([firsts, stops], axis=1))
    return vectors.astype(np.float32)


def _intervals(
    windows: Parts, seconds: float, lasts: IntArray, *, is_one: bool
) -> tuple[FloatArray, FloatArray]:
    """(n,) starts and ends of the likely interval of the query for each window, in seconds.

    is_one: the query has one window, so the intervals have the same middle as the windows. Else
    they begin where the windows begin.
    """
    clip_ends = windows.ends[lasts].astype(np.float64)
    starts = windows.starts.astype(np.float64)
    if is_one:
        starts = np.maximum((starts + windows.ends) / 2 - seconds / 2, 0.0)
    return np.minimum(starts, clip_ends), np.minimum(starts + seconds, clip_ends)


def _touching(
    windows: Parts, starts: FloatArray, ends: FloatArray, excluded: ExcludedInterval | None
) -> BoolArray:
    """(n,) whether a window, or its interval, overlaps the excluded interval."""
    touching = np.zeros(len(windows), dtype=bool)
    if excluded is None:
        return touching
    for number in np.flatnonzero(windows.ids == excluded.clip_id):
        own = slice(*np.searchsorted(windows.owners, [number, number + 1]))
        first = np.minimum(starts[own], windows.starts[own])
        last = np.maximum(ends[own], windows.ends[own])
        touching[own] = (first < excluded.end) & (last > excluded.start)
    return touching
