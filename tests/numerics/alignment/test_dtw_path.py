"""Cheapest paths against the textbook's recursion, one cell after another."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from app.numerics.alignment.dtw_path import cheapest_paths
from app.numerics.arrays import BoolArray, FloatArray

Cells = list[tuple[int, int]]


def naive_total(cost: FloatArray, reach: int, step_cost: float) -> float:
    total = np.full(cost.shape, np.inf)
    for i, j in np.ndindex(cost.shape):
        if abs(i - j) > reach:
            continue
        before = [0.0] if i == j == 0 else []
        if i and j:
            before.append(total[i - 1, j - 1])
        if i:
            before.append(total[i - 1, j] + step_cost)
        if j:
            before.append(total[i, j - 1] + step_cost)
        total[i, j] = cost[i, j] + min(before)
    return float(total[-1, -1])


def cells(path: BoolArray) -> Cells:
    return [(int(i), int(j)) for i, j in np.argwhere(path)]


@pytest.mark.parametrize("size", [1, 2, 3, 9, 32])
def test_each_path_is_a_cheapest_one(size: int) -> None:
    rng = np.random.default_rng(size)
    cost, step_cost = rng.random((20, size, size)), rng.random(20)
    paths = cheapest_paths(cost, 0.2, step_cost)
    reach = max(1, int(0.2 * size))
    for table, path, price in zip(cost, paths, step_cost, strict=True):
        steps = list(pairwise(cells(path)))
        alone = sum(one[0] == other[0] or one[1] == other[1] for one, other in steps)
        found = float(table[path].sum() + price * alone)
        assert found == pytest.approx(naive_total(table, reach, float(price)))


def test_a_path_goes_from_corner_to_corner_by_single_steps_within_the_band() -> None:
    rng = np.random.default_rng(0)
    for path in cheapest_paths(rng.random((30, 16, 16)), 0.25, np.zeros(30)):
        walked = cells(path)
        assert (walked[0], walked[-1]) == ((0, 0), (15, 15))
        steps = {(b[0] - a[0], b[1] - a[1]) for a, b in pairwise(walked)}
        assert steps <= {(1, 1), (1, 0), (0, 1)}
        assert max(abs(i - j) for i, j in walked) <= 4


def test_of_equal_steps_both_sequences_move() -> None:
    (path,) = cheapest_paths(np.zeros((1, 6, 6)), 0.5, np.zeros(1))
    np.testing.assert_array_equal(path, np.eye(6, dtype=bool))


def test_zero_tables_have_zero_paths() -> None:
    assert cheapest_paths(np.zeros((0, 4, 4)), 0.2, np.zeros(0)).shape == (0, 4, 4)
