"""What windows propose for a query: where in clips it might be, and how far that is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from app.analysis.descriptors.windows import WINDOW_SCALES, RunningSums, WindowScale
from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.numerics.euclidean import distances
from app.search.index.span_index import Spans
from app.search.windows.overlap_merging import Candidates

MOST_WINDOWS = 16
"""Of a long query; they stand farther apart the longer it is."""

View = Callable[[WindowScale], Spans]
"""The windows of one scale, with the clips that are meant marked."""


@dataclass(frozen=True, slots=True)
class Piece:
    """The query: features (m, 82) at 10 Hz, and how long it is in seconds."""

    features: FloatArray
    seconds: float


@dataclass(frozen=True, slots=True)
class Barred:
    """A part of a clip, in seconds, in which nothing may be found: the query itself."""

    clip_id: str
    start: float
    end: float


@dataclass(frozen=True, slots=True)
class Proposals:
    """For each row of `spans` the place where the query would be, and its distance.

    starts, ends: (n,) seconds; distances: (n,); rows: (k,) those of clips that are meant and
    touch nothing barred.
    """

    spans: Spans
    starts: FloatArray
    ends: FloatArray
    distances: FloatArray
    rows: IntArray

    def candidates(self) -> Candidates:
        """The places of `rows`, in their order."""
        return Candidates(
            self.spans.ids,
            self.spans.owners[self.rows],
            self.starts[self.rows],
            self.ends[self.rows],
            self.distances[self.rows],
        )

    def distances_near(self, owners: IntArray, centres: FloatArray) -> FloatArray:
        """(k,) distances of the rows of clips `owners` (k,) nearest to times `centres` (k,)."""
        longest = float(self.ends.max(initial=0.0)) + 1.0
        along = self.spans.owners * longest + (self.starts + self.ends) / 2
        sought = owners * longest + centres
        behind = np.searchsorted(along, sought)
        firsts = self.spans.firsts[owners]
        lasts = firsts + self.spans.counts[owners] - 1
        left, right = np.clip(behind - 1, firsts, lasts), np.clip(behind, firsts, lasts)
        is_left = np.abs(along[left] - sought) <= np.abs(along[right] - sought)
        return np.asarray(self.distances[np.where(is_left, left, right)])


def scale_for(frames: int) -> WindowScale:
    """The longest windows that a query of so many frames at 10 Hz fills; else the shortest."""
    filled = [scale for scale in WINDOW_SCALES if scale.frames <= frames]
    return filled[-1] if filled else WINDOW_SCALES[0]


def propose(view: View, piece: Piece, barred: Barred | None) -> Proposals:
    """Compare a query with all windows of the scale that suits it.

    A query that is longer than a window is cut into windows itself, and compared with as many
    in their order; where a clip ends before they do, its last window stands for the missing.
    """
    scale = scale_for(len(piece.features))
    spans = view(scale)
    steps = _steps(len(piece.features), scale)
    apart = distances(_vectors(piece, scale, steps), spans.vectors, spans.squares)
    lasts, rows = spans.last_rows(), np.arange(len(spans))
    total = np.zeros(len(spans))
    for step, row in zip(steps, apart, strict=True):
        total += row[np.minimum(rows + step, lasts)]
    starts, ends = _places(spans, piece.seconds, lasts, is_one=len(steps) == 1)
    meant = spans.passing[spans.owners] & ~_touching(spans, starts, ends, barred)
    return Proposals(spans, starts, ends, total / len(steps), np.flatnonzero(meant))


def _steps(frames: int, scale: WindowScale) -> IntArray:
    """(q,) hops from the query's start to each of its windows, half a window apart or more."""
    last = round((frames - scale.frames) / scale.hop)
    if last <= 0:
        return np.zeros(1, dtype=np.int64)
    apart = max(scale.frames // (2 * scale.hop), -(-last // (MOST_WINDOWS - 1)), 1)
    return np.unique(np.append(np.arange(0, last, apart), last))


def _vectors(piece: Piece, scale: WindowScale, steps: IntArray) -> FloatArray:
    """(q, d) float32 vectors of the query's windows, or of all of it where there is one."""
    frames = len(piece.features)
    firsts = np.minimum(steps * scale.hop, max(frames - scale.frames, 0))
    stops = firsts + scale.frames if len(steps) > 1 else np.array([frames])
    vectors = RunningSums(piece.features).vectors(np.stack([firsts, stops], axis=1))
    return vectors.astype(np.float32)


def _places(
    spans: Spans, seconds: float, lasts: IntArray, *, is_one: bool
) -> tuple[FloatArray, FloatArray]:
    """(n,) starts and ends of the query at each row: around its middle, or from its start."""
    clip_ends = spans.ends[lasts].astype(np.float64)
    starts = spans.starts.astype(np.float64)
    if is_one:
        starts = np.maximum((starts + spans.ends) / 2 - seconds / 2, 0.0)
    return np.minimum(starts, clip_ends), np.minimum(starts + seconds, clip_ends)


def _touching(
    spans: Spans, starts: FloatArray, ends: FloatArray, barred: Barred | None
) -> BoolArray:
    """(n,) whether a row's window or place overlaps what is barred."""
    touching = np.zeros(len(spans), dtype=bool)
    if barred is None:
        return touching
    for number in np.flatnonzero(spans.ids == barred.clip_id):
        own = slice(spans.firsts[number], spans.firsts[number] + spans.counts[number])
        first = np.minimum(starts[own], spans.starts[own])
        last = np.maximum(ends[own], spans.ends[own])
        touching[own] = (first < barred.end) & (last > barred.start)
    return touching
