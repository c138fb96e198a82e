"""Dynamic time warping of one query with many candidates at once.

The accumulated cost D[i, j] = cost[i, j] + min(D[i-1, j], D[i, j-1], D[i-1, j-1]) (Sakoe and Chiba
1978) depends only on the two anti-diagonals before its own. So one numpy step computes a whole
anti-diagonal of a whole batch of candidates. Candidates of similar length share a batch. They are
padded at their ends, which changes no result, because D never looks ahead. A pair whose costs do
not fit is warped in strips of rows of the query. Each strip continues the last row of the one
before it; the result is the same, in memory that grows with the length and not with its square.
Sequences are (frames, dimensions), or (frames,) for one dimension; cost is Euclidean.

This stays ours: one clip against 350 takes 58 ms, with dtaidistance 307, with aeon 344, with
tslearn 430 (one thread; tests/bench/test_dtw.py).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.deadline import check
from app.numerics.arrays import FloatArray, IntArray
from app.numerics.euclidean import distances, squared_lengths

CELLS_AT_ONCE = 1_000_000
"""Cost cells of one batch (4 bytes each): bounds memory, and keeps it near the caches."""

MAX_BATCH = 256

STRIP_CELLS = 16_000_000
"""Cost cells of one strip of a long pair, if that leaves it MIN_ROWS."""

MIN_ROWS, MAX_ROWS = 256, 1024
"""Rows of a strip: fewer cost more steps, more leave the caches. 36 million cells take 0.4 s
with 512 rows, 0.35 s with 1,024, 0.7 s with 6,000, 2.5 s with 64."""


def dtw_distances(
    query: FloatArray, candidates: Sequence[FloatArray], *, per_step: bool = True
) -> FloatArray:
    """(c,) the cost of the cheapest path that warps `query` onto each of the candidates.

    query: (n, d); candidates: c sequences (m, d), in the same unit, which is that of the result.
    per_step: divide each cost by n + m. Raises ValueError for an empty sequence.
    """
    query = _as_table(query)
    lengths = np.array([len(candidate) for candidate in candidates], dtype=np.int64)
    if not len(query) or (len(lengths) and not lengths.min()):
        raise ValueError("cannot warp an empty sequence")
    totals = np.empty(len(lengths))
    center = query.mean(axis=0)  # differences of small numbers keep more digits
    for chosen in _batches(lengths, len(query)):
        check()
        frames = np.concatenate([_as_table(candidates[i]) for i in chosen])
        frames -= center  # in place: these rows are wide, and new memory is dear
        if len(query) * len(frames) > CELLS_AT_ONCE:
            totals[chosen] = _in_strips(query - center, frames)
            continue
        cost = _side_by_side(_costs(query - center, frames, lengths[chosen]), lengths[chosen])
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


def _costs(query: FloatArray, frames: FloatArray, lengths: IntArray) -> FloatArray:
    """(n, k) float32 Euclidean distances of the rows of (n, d) and (k, d).

    Each candidate is multiplied on its own. The cost of a pair must not depend on the other
    candidates of its batch: a ranking that is computed in pieces must agree with itself to the
    last bit.
    """
    if query.shape[1] == 1:
        apart = query - frames[:, 0]
        return np.asarray(np.abs(apart, out=apart))
    ends = np.cumsum(lengths).tolist()
    parts = [slice(first, stop) for first, stop in zip([0, *ends], ends, strict=False)]
    return distances(query, frames, squared_lengths(frames), parts)


def _side_by_side(table: FloatArray, lengths: IntArray) -> FloatArray:
    """(n, m, c) C-contiguous from (n, k), candidates of `lengths` (c,) one after the other.

    Costs are moved, not frames, which are wider. What is behind a candidate's end repeats
    its last frame.
    """
    starts = np.cumsum(lengths) - lengths
    inside = np.minimum(np.arange(lengths.max())[:, None], lengths - 1)
    moved: FloatArray = np.take(table, (starts + inside).ravel(), axis=1)
    return moved.reshape(len(table), int(lengths.max()), len(lengths))


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
        check()
        low, high = max(k - columns + 1, 0), min(k, rows - 1)
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


def _in_strips(query: FloatArray, frames: FloatArray) -> float:
    """The total of one long pair: query (n, d), frames (m, d)."""
    columns = len(frames)
    above = np.full(columns + 1, np.inf, dtype=np.float32)
    above[0] = 0.0  # the corner before the first cell
    count = int(np.clip(STRIP_CELLS // columns, MIN_ROWS, MAX_ROWS))
    for first in range(0, len(query), count):
        rows = query[first : first + count]
        above = _last_row(_costs(rows, frames, np.array([columns])), above)
    return float(above[columns])


def _last_row(cost: FloatArray, above: FloatArray) -> FloatArray:
    """(m + 1,) infinity and D of a strip's last row; above: the same of the row above its first.

    cost: (n, m) C-contiguous. As in `_accumulate`, anti-diagonal k holds D[i, k - i] at row
    i + 1; its row 0 is of the strip above: D[-1, k + 1].
    """
    rows, columns = cost.shape
    older, old, new = (np.full(rows + 2, np.inf, dtype=cost.dtype) for _ in range(3))
    older[0], old[0] = above[0], above[1]
    found, flat, step = np.full_like(above, np.inf), cost.ravel(), max(columns - 1, 1)
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
            found[k - rows + 2] = new[rows]
        older, old, new = old, new, older
    return found
