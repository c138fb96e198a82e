"""Finds a short query in long streams: dynamic time warping with free ends.

Sakoe and Chiba 1978 (table I, asymmetric form, slope constraint P = 1): with c[i, j] the
distance of query frame i to stream frame j,

    D[i, j] = min(D[i-1, j-1] + c[i, j],
                  D[i-1, j-2] + (c[i, j-1] + c[i, j]) / 2,
                  D[i-2, j-1] + c[i-1, j] + c[i, j]),      D[-1, j] = 0.

Every query frame has weight 1. So the costs of matches of any start and length can be compared.
D / n is the mean distance of a query frame to the part of the stream that it is matched with. A
match is between half and twice as long as the query, so it cannot shrink to a single frame. No
cell depends on its own row. So one numpy step computes a row of many streams, laid end to end. The
step to each cell is stored. From every end that is a local minimum, the steps are followed back.

Sequences are (frames, dimensions). A stream is a curve, and its frames are samples of it. Each
stream frame represents two half lines: the first halves of the lines to the frames before and after
it. c is the Euclidean distance of a query frame to the nearest point of these half lines. So the
result hardly depends on the times of the samples.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from app.deadline import check
from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.numerics.euclidean import squared_distances, squared_lengths

MAX_CELLS_AT_ONCE = 4_000_000
"""The largest number of cells (query frames x stream frames) of one table, two bytes each."""

MAX_FRAMES_AT_ONCE = 20_000
"""The largest number of stream frames of one table. So its rows fit the caches."""

MAX_COSTS_AT_ONCE = 250_000
"""The largest number of costs (4 bytes each) that are computed at a time, so that they fit the
caches."""

STILL = 1e-9
"""The squared length up to which a line between two frames counts as a point."""

MAX_MATCH_LENGTH = 2
"""The longest match, in lengths of the query. It follows from the slope constraint."""

WALL = 2
"""Columns before each stream that no path may cross: a step goes back at most two columns."""

_ROWS_BACK = np.array([1, 1, 2, 2])
_COLUMNS_BACK = np.array([1, 2, 1, 1])
"""How many rows and columns a step goes, indexed by its kind: 0 goes one row and one column, 1 goes
two columns, 2 and 3 go two rows."""


@dataclass(frozen=True, slots=True)
class Matches:
    """Matches of a query in streams: those whose cost is a local minimum over their ends.

    streams: (k,) the index of the stream, ascending. starts: (k,) the first frame of the match.
    ends: (k,) the first frame after it, ascending within a stream. costs: (k,) float32, the mean
    distance of a query frame to the part of the stream that it is matched with, in the unit of
    the sequences.
    """

    streams: IntArray
    starts: IntArray
    ends: IntArray
    costs: FloatArray


@dataclass(frozen=True, slots=True)
class _Piece:
    """A part of a stream.

    stream: its index. first: the index in the stream of the first frame of the piece. frames:
    (m, d). valid: matches that end before this frame of the piece are reported by the piece
    before. is_last: whether the piece is at the end of the stream.
    """

    stream: int
    first: int
    frames: FloatArray
    valid: int
    is_last: bool


def subsequence_dtw(query: FloatArray, streams: Sequence[FloatArray]) -> Matches:
    """All matches of `query` (n, d) in `streams`, each (m, d), in the same unit.

    Matches may overlap. Raises ValueError for an empty query, and DeadlineExceeded or ClientLeft
    (app.deadline).
    """
    if not len(query):
        raise ValueError("cannot search for an empty sequence")
    # differences of small numbers keep more digits
    center = np.asarray(query.mean(axis=0, dtype=np.float64), dtype=np.float32)
    centered = np.asarray(query, dtype=np.float32) - center
    at_once = max(min(MAX_FRAMES_AT_ONCE, MAX_CELLS_AT_ONCE // len(query)), 4 * len(query) + 8)
    batches = _batches(streams, len(query), at_once)
    columns = [_in_pieces(centered, pieces, center) for pieces in batches]
    if not columns:
        none = np.zeros(0, dtype=np.int64)
        return Matches(none, none, none, np.zeros(0, dtype=np.float32))
    return Matches(*(np.concatenate(column) for column in zip(*columns, strict=True)))


_Columns = tuple[IntArray, IntArray, IntArray, FloatArray]
"""Streams, starts, ends and costs (k,), as `Matches` has them."""


def _batches(
    streams: Sequence[FloatArray], query_frames: int, at_once: int
) -> Iterator[list[_Piece]]:
    """Pieces of the streams in their order, in batches of up to `at_once` frames."""
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
    """A long stream in pieces that overlap by more than the length of a match.

    So no match is lost. The first and the last frame of a piece lack the line to the next frame
    of the stream. A piece reports no match that touches them.
    """
    overlap = MAX_MATCH_LENGTH * query_frames + 3
    first, valid = 0, 0
    while len(whole) - first > at_once:
        yield _Piece(stream, first, whole[first : first + at_once], valid, is_last=False)
        # the last two ends of a piece are uncertain; the next piece reports them
        first, valid = first + at_once - 2 - overlap, overlap
    if len(whole) > first:
        yield _Piece(stream, first, whole[first:], valid, is_last=True)


def _in_pieces(query: FloatArray, pieces: Sequence[_Piece], center: FloatArray) -> _Columns:
    """The matches of `query` (n, d), less `center` (d,), in pieces that are searched together."""
    laid, firsts = _end_to_end(pieces, center)
    costs, skips, stays = _accumulate(query, laid, firsts)
    ends = np.concatenate([_ends(costs, p, f) for p, f in zip(pieces, firsts, strict=True)])
    starts = _starts(skips, stays, ends)
    which = np.searchsorted(firsts, ends, side="right") - 1
    offset = np.array([piece.first for piece in pieces])[which] - firsts[which]
    streams = np.array([piece.stream for piece in pieces])[which]
    return streams, starts + offset, ends + 1 + offset, costs[ends] / len(query)


def _end_to_end(pieces: Sequence[_Piece], center: FloatArray) -> tuple[FloatArray, IntArray]:
    """(k, d) float32, the pieces less `center` with zeros between them, and their first columns."""
    lengths = np.array([len(piece.frames) for piece in pieces])
    firsts = np.cumsum(lengths + WALL) - lengths
    laid = np.zeros((int(firsts[-1] + lengths[-1]), len(center)), dtype=np.float32)
    for first, piece in zip(firsts, pieces, strict=True):
        np.subtract(piece.frames, center, out=laid[first : first + len(piece.frames)])
    return laid, firsts


def _accumulate(
    query: FloatArray, laid: FloatArray, firsts: IntArray
) -> tuple[FloatArray, BoolArray, BoolArray]:
    """(k,) the total costs of the matches that end at each column, and the step to each cell.

    The steps are two arrays (n, k): whether a cell was reached from two columns back (skips), and
    from two rows back (stays). D[-1] is 0 in every column, so a match may begin anywhere.
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
    """For each query frame, its (k,) distances to the columns; walls are infinitely far.

    The line to a wall is no part of a stream, so it is left out.
    """
    lengths = squared_lengths(laid)
    walls = np.concatenate([firsts - back for back in range(1, WALL + 1)])
    steps = squared_lengths(laid[1:] - laid[:-1])
    is_line = steps > STILL
    is_line[walls[walls < len(steps)]] = False
    is_line[walls[walls > 0] - 1] = False
    share = np.zeros_like(steps)
    np.divide(0.25, steps, out=share, where=is_line)
    rows = max(1, MAX_COSTS_AT_ONCE // len(laid))
    for first in range(0, len(query), rows):
        costs = squared_distances(query[first : first + rows], laid, lengths)
        _use_half_lines(costs, steps, share)
        costs[:, walls] = np.inf
        yield from np.sqrt(costs, out=costs)


def _use_half_lines(squares: FloatArray, steps: FloatArray, share: FloatArray) -> None:
    """Change squared distances to columns into squared distances to their half lines, in place.

    squares: (n, k) squared distances to the columns. steps: (k - 1,) squared lengths s of the lines
    from a column to the next. share: (k - 1,) 1 / (4 s), 0 where there is no line.

    Let a and b be the squared distances to the ends of a line. The squared distance to its point
    t is a - t g + t^2 s, with g = a - b + s. It is smallest at t = g / (2 s), which for the first
    half is limited to 0..1/2. For the half of the next column, a and b are exchanged.
    """
    to_here, to_next = squares[:, :-1].copy(), squares[:, 1:].copy()
    gain = to_here - to_next
    gain += steps
    clipped = np.clip(gain, 0.0, steps)
    to_here -= clipped * (2.0 * gain - clipped) * share
    np.subtract(2.0 * steps, gain, out=gain)
    np.clip(gain, 0.0, steps, out=clipped)
    to_next -= clipped * (2.0 * gain - clipped) * share
    np.minimum(squares[:, :-1], to_here, out=squares[:, :-1])
    np.minimum(squares[:, 1:], to_next, out=squares[:, 1:])
    # only rounding makes values negative
    np.maximum(squares, 0.0, out=squares)


def _ends(costs: FloatArray, piece: _Piece, first: int) -> IntArray:
    """The columns of a piece at which the cost of a match that ends there is a local minimum.

    costs: (columns,) of all pieces. first: the first column of the piece.
    """
    own = np.concatenate([[np.inf], costs[first : first + len(piece.frames)], [np.inf]])
    is_minimum = (own[1:-1] <= own[:-2]) & (own[1:-1] < own[2:]) & np.isfinite(own[1:-1])
    is_minimum[: piece.valid] = False
    if not piece.is_last:
        is_minimum[-2:] = False
    return np.flatnonzero(is_minimum) + first


def _starts(skips: BoolArray, stays: BoolArray, ends: IntArray) -> IntArray:
    """(k,) the first columns of the matches that end at the columns `ends` (k,).

    All matches are followed back together, one step at a time.
    """
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
