"""Dynamic time warping of one query with many candidates at once.

The accumulated cost D[i, j] = cost[i, j] + min(D[i-1, j], D[i, j-1], D[i-1, j-1]) (Sakoe and Chiba
1978) depends only on the two anti-diagonals before its own. So one numpy step computes a whole
anti-diagonal of a whole batch of candidates. Candidates of similar length share a batch. They are
padded at their ends, which changes no result, because D never looks ahead. A pair whose costs do
not fit is warped in strips of rows of the query. Each strip continues the last row of the one
before it; the result is the same, in memory that grows with the length and not with its square.
Sequences are (frames, dimensions), or (frames,) for one dimension; cost is Euclidean.

This is our own code, because it is faster: one clip against 350 takes 58 ms, with dtaidistance
307, with aeon 344, with tslearn 430 (one thread; tests/bench/test_dtw.py).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.deadline import check
from app.numerics.alignment.cost_tables import (
    MAX_CELLS_AT_ONCE,
    as_table,
    batches,
    costs,
    side_by_side,
)
from app.numerics.arrays import FloatArray, IntArray

STRIP_CELLS = 16_000_000
"""The number of cost cells of one strip of a long pair, within MIN_ROWS and MAX_ROWS."""

MIN_ROWS, MAX_ROWS = 256, 1024
"""Bounds of the number of rows of a strip. Fewer rows need more steps. More rows do not fit the
caches. 36 million cells take 0.4 s with 512 rows, 0.35 s with 1,024, 0.7 s with 6,000, 2.5 s with
64."""


def dtw_distances(
    query: FloatArray, candidates: Sequence[FloatArray], *, per_step: bool = True
) -> FloatArray:
    """(c,) the cost of the cheapest path that warps `query` onto each of c candidates.

    query: (n, d) or (n,). candidates: (m, d) or (m,) each, in the same unit, which is also the
    unit of the result. per_step: whether each cost is divided by n + m. The result is float64,
    computed in float32. Raises ValueError for an empty sequence, and DeadlineExceeded or
    ClientLeft (app.deadline).
    """
    query = as_table(query)
    lengths = np.array([len(candidate) for candidate in candidates], dtype=np.int64)
    if not len(query) or (len(lengths) and not lengths.min()):
        raise ValueError("cannot warp an empty sequence")
    totals = np.empty(len(lengths))
    center = query.mean(axis=0)  # differences of small numbers keep more digits
    for batch in batches(lengths, len(query)):
        check()
        frames = np.concatenate([as_table(candidates[i]) for i in batch])
        frames -= center  # in place: these rows are wide, and new memory costs time
        if len(query) * len(frames) > MAX_CELLS_AT_ONCE:
            totals[batch] = _in_strips(query - center, frames)
            continue
        cost = side_by_side(costs(query - center, frames, lengths[batch]), lengths[batch])
        totals[batch] = _accumulate(cost, lengths[batch])
    return totals / (len(query) + lengths) if per_step else totals


def _accumulate(cost: FloatArray, lengths: IntArray) -> FloatArray:
    """(c,) the total cost D at the last frame of each candidate.

    cost: (n, m, c) C-contiguous. lengths: (c,), at most m.

    Anti-diagonal k holds D[i, k - i] at row i + 1. A row of infinity before and after it stands
    for the cells outside the table. The next two diagonals read no other cells outside it.
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
        check()
        low, high = max(k - columns + 1, 0), min(k, rows - 1)
        inside = new[low + 1 : high + 2]
        np.minimum(old[low + 1 : high + 2], old[low : high + 1], out=inside)
        np.minimum(inside, older[low : high + 1], out=inside)
        # the costs of an anti-diagonal are equally far apart in the flat array
        start, last = low * columns + k - low, high * columns + k - high
        inside += flat[start : last + 1 : step]
        new[low] = np.inf
        new[high + 2] = np.inf
        if k >= first_end:
            np.copyto(totals, new[rows], where=ends == k)
        older, old, new = old, new, older
    return totals


def _in_strips(query: FloatArray, frames: FloatArray) -> float:
    """The total D of one long pair: query (n, d), frames (m, d)."""
    columns = len(frames)
    above = np.full(columns + 1, np.inf, dtype=np.float32)
    above[0] = 0.0  # the corner before the first cell
    count = int(np.clip(STRIP_CELLS // columns, MIN_ROWS, MAX_ROWS))
    for first in range(0, len(query), count):
        rows = query[first : first + count]
        above = _last_row(costs(rows, frames, np.array([columns])), above)
    return float(above[columns])


def _last_row(cost: FloatArray, above: FloatArray) -> FloatArray:
    """(m + 1,) infinity, then D of the last row of a strip.

    cost: (n, m) C-contiguous. above: (m + 1,) the same for the row above the strip. As in
    `_accumulate`, anti-diagonal k holds D[i, k - i] at row i + 1. Its row 0 belongs to the strip
    above: D[-1, k + 1].
    """
    rows, columns = cost.shape
    older, old, new = (np.full(rows + 2, np.inf, dtype=cost.dtype) for _ in range(3))
    older[0], old[0] = above[0], above[1]
    last_row, flat, step = np.full_like(above, np.inf), cost.ravel(), max(columns - 1, 1)
    for k in range(rows + columns - 1):
        check()
        low, high = max(k - columns + 1, 0), min(k, rows - 1)
        inside = new[low + 1 : high + 2]
        np.minimum(old[low + 1 : high + 2], old[low : high + 1], out=inside)
        np.minimum(inside, older[low : high + 1], out=inside)
        start, last = low * columns + k - low, high * columns + k - high
        inside += flat[start : last + 1 : step]
        new[low] = np.inf
        new[high + 2 :][:1] = np.inf
        if k + 2 <= columns:
            new[0] = above[k + 2]
        if k >= rows - 1:
            last_row[k - rows + 2] = new[rows]
        older, old, new = old, new, older
    return last_row
