"""The cheapest path of dynamic time warping through each of many tables of equal size.

`app.numerics.alignment.dtw` computes the cost of the cheapest path. This module finds its cells
(Sakoe and Chiba 1978, "Dynamic programming algorithm optimization for spoken word recognition",
symmetric steps, with their band). The tables are small and many. So one step computes an
anti-diagonal of all tables, and all paths are followed back together.
"""

from __future__ import annotations

import numpy as np

from app.numerics.arrays import BoolArray, FloatArray, IntArray

BOTH, OWN, OTHER = 0, 1, 2
"""The step that leads to a cell: in both sequences, in the first alone, in the second alone."""


def cheapest_paths(cost: FloatArray, band: float, step_cost: FloatArray) -> BoolArray:
    """(n, m, m) which cells are on the cheapest path of each table, from corner to corner.

    cost: (n, m, m), m >= 1: the cost of matching moment i of a table's first sequence with
    moment j of its second one. band: 0..1, the largest |i - j| as a share of m, at least one
    moment. step_cost: (n,) the extra cost of a step in one sequence alone, in the unit of
    `cost`; it keeps paths from following noise. Of equally cheap steps the path takes BOTH
    before OWN before OTHER.
    """
    count, size, _ = cost.shape
    steps = _steps(cost, max(1, int(band * size)), step_cost)
    path = np.zeros(cost.shape, dtype=bool)
    table, own, other = np.arange(count), np.full(count, size - 1), np.full(count, size - 1)
    for _ in range(2 * size - 1):
        path[table, own, other] = True
        step = steps[table, own + other, own]
        own, other = own - (step != OTHER), other - (step != OWN)
        going = own >= 0  # a path ends before the first cell
        table, own, other = table[going], own[going], other[going]
    return path


def _steps(cost: FloatArray, reach: int, step_cost: FloatArray) -> IntArray:
    """(n, 2 m - 1, m) the step that leads to each cell, indexed by i + j and by i.

    cost, step_cost: as in `cheapest_paths`. reach: the largest |i - j|.
    """
    count, size, _ = cost.shape
    own, other = np.nonzero(np.abs(np.subtract.outer(np.arange(size), np.arange(size))) <= reach)
    diagonals = np.full((2 * size - 1, size, count), np.inf)
    diagonals[own + other, own] = cost[:, own, other].T
    # Two diagonals and one row of infinity come first, so that every cell has predecessors.
    total = np.full((2 * size + 1, size + 1, count), np.inf)
    total[0, 0] = 0.0
    for number, here in enumerate(diagonals):
        alone = np.minimum(total[number + 1, :-1], total[number + 1, 1:])
        alone += step_cost
        np.minimum(alone, total[number, :-1], out=alone)
        np.add(alone, here, out=total[number + 2, 1:])
    before_own, before_other = total[1:-1, :-1], total[1:-1, 1:]
    steps = np.where(before_own <= before_other, OWN, OTHER)
    steps[total[:-2, :-1] <= np.minimum(before_own, before_other) + step_cost] = BOTH
    return steps.transpose(2, 0, 1)
