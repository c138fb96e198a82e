"""Dynamic time warping, vectorised over candidates.

The accumulated cost D[i, j] = cost[i, j] + min(D[i-1, j], D[i, j-1], D[i-1, j-1]) depends
only on the two anti-diagonals before its own, so one numpy step computes a whole
anti-diagonal of a whole batch of candidates. Candidates of similar length share a batch;
padding at their ends is harmless because D never looks ahead.
Sequences are (frames, dimensions), or (frames,) for one dimension; cost is Euclidean.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.numerics.arrays import FloatArray, IntArray

CELLS_AT_ONCE = 1_000_000
"""Cost cells of one batch (4 bytes each): bounds memory, and keeps it near the caches."""

MAX_BATCH = 256

TOO_CLOSE = 1e-4
"""Squared distances below this share of the squared lengths are taken again, exactly:
as |a|^2 + |b|^2 - 2ab they have lost their digits, and equal frames would be apart."""


RETAKEN_AT_ONCE = 10_000


def dtw_distance(
    a: FloatArray, b: FloatArray, *, band: float | None = None, per_step: bool = True
) -> float:
    """The cost of the cheapest warping of `a` (n, d) onto `b` (m, d), divided by n + m.

    band: see `dtw_distances`; per_step=False leaves the total undivided.
    """
    return float(dtw_distances(a, [b], band=band, per_step=per_step)[0])


def dtw_distances(
    query: FloatArray,
    candidates: Sequence[FloatArray],
    *,
    band: float | None = None,
    per_step: bool = True,
) -> FloatArray:
    """(c,) DTW cost of `query` (n, d) against each of `candidates`, each (m, d).

    band: largest difference between the shares of the two sequences that have passed where
    they meet, 0..1 (Sakoe-Chiba's band on the true diagonal); None is no band. The band is
    never narrower than one step of the shorter sequence, so that a path exists.
    per_step: divide the total by n + m. Raises ValueError for an empty sequence.
    """
    query = _as_table(query)
    lengths = np.array([len(candidate) for candidate in candidates], dtype=np.int64)
    if not len(query) or (len(lengths) and not lengths.min()):
        raise ValueError("cannot warp an empty sequence")
    totals = np.empty(len(lengths))
    centre = query.mean(axis=0)  # differences of small numbers keep more digits
    for chosen in _batches(lengths, len(query)):
        cost = _costs(query - centre, _stacked([candidates[i] for i in chosen], centre))
        if band is not None:
            _forbid_outside(cost, lengths[chosen], band)
        totals[chosen] = _accumulate(cost, lengths[chosen])
    return totals / (len(query) + lengths) if per_step else totals


def _as_table(sequence: FloatArray) -> FloatArray:
    table = np.asarray(sequence, dtype=np.float32)
    return table[:, None] if table.ndim == 1 else table


def _batches(lengths: IntArray, frames: int) -> list[IntArray]:
    """Indices grouped so that lengths are alike and a batch's costs fit CELLS_AT_ONCE."""
    order = np.argsort(-lengths, kind="stable")
    batches: list[IntArray] = []
    first = 0
    while first < len(order):
        longest = int(lengths[order[first]])
        count = int(np.clip(CELLS_AT_ONCE // (frames * longest), 1, MAX_BATCH))
        batches.append(order[first : first + count])
        first += count
    return batches


def _stacked(candidates: list[FloatArray], centre: FloatArray) -> FloatArray:
    """(m, c, d): candidates side by side, less `centre` (d,), zeros after their ends."""
    longest = max(len(candidate) for candidate in candidates)
    stacked = np.zeros((longest, len(candidates), len(centre)), dtype=np.float32)
    for index, candidate in enumerate(candidates):
        np.subtract(_as_table(candidate), centre, out=stacked[: len(candidate), index])
    return stacked


def _costs(query: FloatArray, stacked: FloatArray) -> FloatArray:
    """(n, m, c) float32 Euclidean distances between frames; (n, d) and (m, c, d) in."""
    if query.shape[1] == 1:
        differences = query[:, :, None] - stacked[None, :, :, 0]
        return np.asarray(np.abs(differences, out=differences))
    frames, count, dimensions = stacked.shape
    columns = stacked.reshape(-1, dimensions)
    lengths = np.einsum("kd,kd->k", columns, columns)
    squares = (-2.0 * query) @ columns.T
    squares += np.einsum("nd,nd->n", query, query)[:, None]
    squares += lengths
    _retake_close(squares, query, columns, TOO_CLOSE * lengths)
    return np.asarray(np.sqrt(squares, out=squares).reshape(len(query), frames, count))


def _retake_close(
    squares: FloatArray, rows: FloatArray, columns: FloatArray, least: FloatArray
) -> None:
    """Compute anew, in place, the (n, k) `squares` that are not above `least` (k,)."""
    # flat: numpy's two-dimensional nonzero is many times slower
    row, column = np.divmod(np.flatnonzero(squares <= least), squares.shape[1])
    for first in range(0, len(row), RETAKEN_AT_ONCE):
        some = slice(first, first + RETAKEN_AT_ONCE)
        apart = rows[row[some]] - columns[column[some]]
        squares[row[some], column[some]] = np.einsum("ki,ki->k", apart, apart)


def _forbid_outside(cost: FloatArray, lengths: IntArray, band: float) -> None:
    """Make cells of (n, m, c) `cost` outside the band infinitely dear, in place."""
    rows, columns, _ = cost.shape
    short = np.minimum(rows, lengths)
    passed = np.arange(rows)[:, None, None] / max(rows - 1, 1)
    other = np.arange(columns)[None, :, None] / np.maximum(lengths - 1, 1)
    width = np.maximum(band, 1.0 / np.maximum(short - 1, 1))
    cost[np.abs(passed - other) > width + 1e-12] = np.inf


def _accumulate(cost: FloatArray, lengths: IntArray) -> FloatArray:
    """(c,) totals at each candidate's last frame; cost (n, m, c) C-contiguous.

    Anti-diagonal k holds D[i, k - i] at row i + 1, between two rows of infinity: the walls
    outside the table, of which the next two diagonals read no more than one row.
    """
    rows, columns, count = cost.shape
    totals = np.empty(count, dtype=cost.dtype)
    ends = lengths + rows - 2
    older, old, new = (np.full((rows + 2, count), np.inf, dtype=cost.dtype) for _ in range(3))
    older[0] = 0.0  # the corner before the first cell
    flat = cost.reshape(rows * columns, count)
    step = max(columns - 1, 1)
    first_end = int(ends.min())
    for k in range(rows + columns - 1):
        low, high = max(0, k - columns + 1), min(rows - 1, k)
        inside = new[low + 1 : high + 2]
        np.minimum(old[low + 1 : high + 2], old[low : high + 1], out=inside)
        np.minimum(inside, older[low : high + 1], out=inside)
        start, last = low * columns + k - low, high * columns + k - high
        inside += flat[start : last + 1 : step]
        new[low] = np.inf
        new[high + 2] = np.inf
        if k >= first_end:
            np.copyto(totals, new[rows], where=ends == k)
        older, old, new = old, new, older
    return totals
