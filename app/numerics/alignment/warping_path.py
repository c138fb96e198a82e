"""The path that warps one sequence onto another at the least cost.

`app.numerics.alignment.dtw` computes the cost of the same path for many candidates, and keeps no
path. This module keeps the whole table of one pair and follows the path back (Sakoe and Chiba 1978,
"Dynamic programming algorithm optimization for spoken word recognition", symmetric steps, without
a band). It computes in float64, so that two equal frames have the cost 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from app.deadline import check
from app.numerics.arrays import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class WarpingPath:
    """The cheapest path of a pair of sequences with n and m frames.

    cells: (k, 2) the frames of both sequences that are matched, from (0, 0) to (n - 1, m - 1).
    cost: the sum of the distances of the cells, divided by n + m, in the unit of the sequences.
    It is what `dtw_distances` gives for the pair.
    """

    cells: IntArray
    cost: float


def warping_path(one: FloatArray, other: FloatArray) -> WarpingPath:
    """The cheapest path from `one` (n, d) to `other` (m, d), sequences in the same unit.

    It needs 8 (n + 1) (m + 1) bytes twice. Of equally cheap steps it takes the one in both
    sequences, then the one in the longer sequence. So exchanging two sequences of different
    lengths exchanges the columns of the path. Raises ValueError for an empty sequence, and
    DeadlineExceeded or ClientLeft (app.deadline).
    """
    if not len(one) or not len(other):
        raise ValueError("cannot warp an empty sequence")
    if len(one) < len(other):
        mirrored = warping_path(other, one)
        return WarpingPath(mirrored.cells[:, ::-1], mirrored.cost)
    totals = _totals(scipy.spatial.distance.cdist(one, other))
    return WarpingPath(_followed_back(totals), float(totals[-1, -1]) / (len(one) + len(other)))


def _totals(cost: FloatArray) -> FloatArray:
    """(n + 1, m + 1) D[i, j] at row i + 1 and column j + 1, after a row and a column of infinity.

    cost: (n, m). D depends only on the two anti-diagonals before its own. Cells of an
    anti-diagonal are equally far apart in the flat array. So each is one numpy step.
    """
    rows, columns = cost.shape
    totals = np.full((rows + 1, columns + 1), np.inf)
    totals[0, 0] = 0.0
    totals[1:, 1:] = cost
    flat, width = totals.ravel(), columns + 1
    for k in range(rows + columns - 1):
        check()
        low, high = max(k - columns + 1, 0), min(k, rows - 1)
        first, last = (low + 1) * width + k - low + 1, (high + 1) * width + k - high + 1
        here, above, before = (
            flat[first - back : last - back + 1 : columns] for back in (0, width, 1)
        )
        both = flat[first - width - 1 : last - width : columns]
        here += np.minimum(both, np.minimum(above, before))
    return totals


def _followed_back(totals: FloatArray) -> IntArray:
    """(k, 2) the cells of the path, from the table of `_totals`."""
    row, column = totals.shape[0] - 1, totals.shape[1] - 1
    cells = []
    while row and column:
        cells.append((row - 1, column - 1))
        both, above, before = (
            totals[row - 1, column - 1],
            totals[row - 1, column],
            totals[row, column - 1],
        )
        is_both = both <= min(above, before)
        is_above = not is_both and above <= before
        row, column = row - (is_both or is_above), column - (not is_above)
    return np.array(cells[::-1], dtype=np.int64)
