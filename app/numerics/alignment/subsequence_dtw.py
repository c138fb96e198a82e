"""Where in long streams a short query occurs: dynamic time warping with both ends free.

Sakoe and Chiba 1978 (table I, asymmetric form, slope constraint P = 1): with c[i, j] the
distance of query frame i to stream frame j,

    D[i, j] = min(D[i-1, j-1] + c[i, j],
                  D[i-1, j-2] + (c[i, j-1] + c[i, j]) / 2,
                  D[i-2, j-1] + c[i-1, j] + c[i, j]),      D[-1, j] = 0.

Every query frame weighs one, so that matches of any start and length compare fairly and
D / n is the mean distance of a query frame to where it is found; a match is between half
and twice as long as the query, so that none shrinks to a single frame. No cell depends on
its own row: one numpy step computes a row of many streams laid end to end. Which of the
three each cell took is kept, and followed back from every end that is a local minimum.
Sequences are (frames, dimensions). A stream is a curve of which its frames are samples, and
each stands for the lines half-way to the frames beside it: c is the Euclidean distance of a
query frame to those. So it does not matter where between two movements the samples fell.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from app.deadline import check
from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.numerics.euclidean import squared_distances, squared_lengths

CELLS_AT_ONCE = 4_000_000
"""Cells (query frames x stream frames) of one table; two bytes each."""

MAX_FRAMES_AT_ONCE = 20_000
"""Frames of one table: its rows stay near the caches."""

COSTS_AT_ONCE = 250_000
"""Costs (4 bytes each) that are computed at a time: near the caches."""

STILL = 1e-9
"""Squared length below which a line between two frames is a point."""

MAX_MATCH_LENGTH = 2
"""Of the query's length: the slope constraint."""

WALL = 2
"""Columns before each stream that no path may cross: as far as a path looks back."""

_ROWS_BACK = np.array([1, 1, 2, 2])
_COLUMNS_BACK = np.array([1, 2, 1, 1])
"""By what a cell took: 0 one step of both, 1 two columns, 2 or 3 two rows."""


@dataclass(frozen=True, slots=True)
class Matches:
    """Matches of a query in streams: those that are no dearer than others ending beside them.

    streams: (k,) index of the stream, ascending; starts, ends: (k,) the first frame of the
    match and the first behind it, ends ascending within a stream; costs: (k,) float32, mean
    distance of a query frame to where it is matched.
    """

    streams: IntArray
    starts: IntArray
    ends: IntArray
    costs: FloatArray


@dataclass(frozen=True, slots=True)
class _Piece:
    """Frames of a stream: of those that end in it, only matches behind `valid` are its own."""

    stream: int
    first: int
    frames: FloatArray
    valid: int
    is_last: bool


def subsequence_dtw(query: FloatArray, streams: Sequence[FloatArray]) -> Matches:
    """The matches of `query` (n, d) in `streams`, each (m, d).

    Raises ValueError for an empty query.
    """
    if not len(query):
        raise ValueError("cannot look for an empty sequence")
    # differences of small numbers keep more digits
    center = np.asarray(query.mean(axis=0, dtype=np.float64), dtype=np.float32)
    wanted = np.asarray(query, dtype=np.float32) - center
    at_once = max(min(MAX_FRAMES_AT_ONCE, CELLS_AT_ONCE // len(query)), 4 * len(query) + 8)
    found = [_in_pieces(wanted, some, center) for some in _batches(streams, len(query), at_once)]
    if not found:
        nothing = np.zeros(0, dtype=np.int64)
        return Matches(nothing, nothing, nothing, np.zeros(0, dtype=np.float32))
    return Matches(*(np.concatenate(column) for column in zip(*found, strict=True)))


_Columns = tuple[IntArray, IntArray, IntArray, FloatArray]


def _batches(
    streams: Sequence[FloatArray], query_frames: int, at_once: int
) -> Iterator[list[_Piece]]:
    """Pieces of the streams in their order, up to `at_once` frames together."""
    batch: list[_Piece] = []
    frames = 0
    for stream, whole in enumerate(streams):
        for piece in _pieces(stream, whole, query_frames, at_once):
            if batch and frames + len(piece.frames) > at_once:
                yield batch
                batch, frames = [], 0
            batch.append(piece)
            frames += len(piece.frames) + WALL
    if batch:
        yield batch


def _pieces(stream: int, whole: FloatArray, query_frames: int, at_once: int) -> Iterator[_Piece]:
    """A long stream in pieces that overlap by more than a match is long: nothing is lost.

    A piece's first and last frames stand for less than they do in the stream, as they lack the
    line to the frame beside them: no match that counts touches them.
    """
    overlap = MAX_MATCH_LENGTH * query_frames + 3
    first, valid = 0, 0
    while len(whole) - first > at_once:
        yield _Piece(stream, first, whole[first : first + at_once], valid, is_last=False)
        # the last two ends of a piece are not sure there; they are the first of the next piece
        first, valid = first + at_once - 2 - overlap, overlap
    if len(whole) > first:
        yield _Piece(stream, first, whole[first:], valid, is_last=True)


def _in_pieces(query: FloatArray, pieces: Sequence[_Piece], center: FloatArray) -> _Columns:
    laid, firsts = _end_to_end(pieces, center)
    costs, skips, stays = _accumulate(query, laid, firsts)
    ends = np.concatenate([_ends(costs, p, f) for p, f in zip(pieces, firsts, strict=True)])
    starts = _starts(skips, stays, ends)
    which = np.searchsorted(firsts, ends, side="right") - 1
    offset = np.array([piece.first for piece in pieces])[which] - firsts[which]
    streams = np.array([piece.stream for piece in pieces])[which]
    return streams, starts + offset, ends + 1 + offset, costs[ends] / len(query)


def _end_to_end(pieces: Sequence[_Piece], center: FloatArray) -> tuple[FloatArray, IntArray]:
    """((k, d) float32 pieces less `center`, zeros for walls), and their first columns."""
    lengths = np.array([len(piece.frames) for piece in pieces])
    firsts = np.cumsum(lengths + WALL) - lengths
    laid = np.zeros((int(firsts[-1] + lengths[-1]), len(center)), dtype=np.float32)
    for first, piece in zip(firsts, pieces, strict=True):
        np.subtract(piece.frames, center, out=laid[first : first + len(piece.frames)])
    return laid, firsts


def _accumulate(
    query: FloatArray, laid: FloatArray, firsts: IntArray
) -> tuple[FloatArray, BoolArray, BoolArray]:
    """(k,) total costs of the matches that end at each column, and what each cell took.

    skips, stays: (n, k), whether a cell came from two columns, or two rows, back. The row
    before the first is free everywhere: there a match may begin with the next column.
    """
    columns = len(laid)
    skips, stays = (np.zeros((len(query), columns), dtype=bool) for _ in range(2))
    oldest, older, now = (np.full(columns, np.inf, np.float32) for _ in range(3))
    older[:] = 0.0
    before, other = np.full(columns, np.inf, np.float32), np.empty(columns - 2, np.float32)
    for row, cost in enumerate(_cost_rows(query, laid, firsts)):
        check()
        here, best = cost[2:], now[2:]
        np.add(older[1:-1], here, out=best)
        np.add(cost[1:-1], here, out=other)
        other *= 0.5
        other += older[:-2]
        np.less(other, best, out=skips[row, 2:])
        np.minimum(best, other, out=best)
        np.add(oldest[1:-1], before[2:], out=other)
        other += here
        np.less(other, best, out=stays[row, 2:])
        np.minimum(best, other, out=best)
        now[:2] = np.inf
        oldest, older, now, before = older, now, oldest, cost
    return older, skips, stays


def _cost_rows(query: FloatArray, laid: FloatArray, firsts: IntArray) -> Iterator[FloatArray]:
    """For each query frame its (k,) distances to the columns; walls are infinitely far."""
    squares = squared_lengths(laid)
    walls = np.concatenate([firsts - back for back in range(1, WALL + 1)])
    steps = squared_lengths(laid[1:] - laid[:-1])
    is_line = steps > STILL
    is_line[walls[walls < len(steps)]] = False
    is_line[walls[walls > 0] - 1] = False
    share = np.zeros_like(steps)
    np.divide(0.25, steps, out=share, where=is_line)
    rows = max(1, COSTS_AT_ONCE // len(laid))
    for first in range(0, len(query), rows):
        costs = squared_distances(query[first : first + rows], laid, squares)
        _draw_near(costs, steps, share)
        costs[:, walls] = np.inf
        yield from np.sqrt(costs, out=costs)


def _draw_near(apart: FloatArray, steps: FloatArray, share: FloatArray) -> None:
    """From squared distances (n, k) to the columns to those to the lines half-way, in place.

    steps: (k - 1,) squared lengths s of the lines from a column to the next; share: 1 / (4 s),
    0 where there is no line. With a and b the squared distances to a line's ends, that to the
    point at t of it is a - t g + t^2 s, g = a - b + s: least at t = g / (2 s), for the near half
    held to 0..1/2. For the half that is the next column's, a and b change places.
    """
    to_here, to_next = apart[:, :-1].copy(), apart[:, 1:].copy()
    gain = to_here - to_next
    gain += steps
    held = np.clip(gain, 0.0, steps)
    to_here -= held * (2.0 * gain - held) * share
    np.subtract(2.0 * steps, gain, out=gain)
    np.clip(gain, 0.0, steps, out=held)
    to_next -= held * (2.0 * gain - held) * share
    np.minimum(apart[:, :-1], to_here, out=apart[:, :-1])
    np.minimum(apart[:, 1:], to_next, out=apart[:, 1:])
    # below 0 only by rounding
    np.maximum(apart, 0.0, out=apart)


def _ends(costs: FloatArray, piece: _Piece, first: int) -> IntArray:
    """Columns of the ends in a piece that are no dearer than those beside them."""
    own = np.concatenate([[np.inf], costs[first : first + len(piece.frames)], [np.inf]])
    least = (own[1:-1] <= own[:-2]) & (own[1:-1] < own[2:]) & np.isfinite(own[1:-1])
    least[: piece.valid] = False
    if not piece.is_last:
        least[-2:] = False
    return np.flatnonzero(least) + first


def _starts(skips: BoolArray, stays: BoolArray, ends: IntArray) -> IntArray:
    """(k,) columns at which the matches that end at columns `ends` (k,) begin."""
    width = skips.shape[1]
    took_skip, took_stay = skips.reshape(-1).view(np.uint8), stays.reshape(-1).view(np.uint8)
    columns, rows = ends.copy(), np.full(len(ends), len(skips) - 1)
    going = np.arange(len(ends))
    while len(going):
        cells = rows[going] * width + columns[going]
        took = took_skip[cells] + 2 * took_stay[cells]
        rows[going] -= _ROWS_BACK[took]
        columns[going] -= _COLUMNS_BACK[took]
        going = going[rows[going] >= 0]
    return columns + 1
