"""The warping path against the textbook's recursion, and against the distances of searches."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.numerics.alignment.dtw import dtw_distances
from app.numerics.alignment.warping_path import warping_path
from app.numerics.arrays import FloatArray

lengths = st.integers(1, 14)


def random_walk(seed: int, frames: int, dimensions: int = 3) -> FloatArray:
    return np.random.default_rng(seed).normal(size=(frames, dimensions)).cumsum(axis=0)


def naive_cost(one: FloatArray, other: FloatArray) -> float:
    total = np.full((len(one), len(other)), np.inf)
    for i, j in np.ndindex(total.shape):
        before = [0.0] if i == j == 0 else []
        if i and j:
            before.append(total[i - 1, j - 1])
        if i:
            before.append(total[i - 1, j])
        if j:
            before.append(total[i, j - 1])
        total[i, j] = float(np.linalg.norm(one[i] - other[j])) + min(before)
    return float(total[-1, -1]) / (len(one) + len(other))


@given(seed=st.integers(0, 10**6), n=lengths, m=lengths)
def test_the_path_is_one_of_single_steps_with_the_least_cost(seed: int, n: int, m: int) -> None:
    one, other = random_walk(seed, n), random_walk(seed + 1, m)
    path = warping_path(one, other)
    cells = [(int(i), int(j)) for i, j in path.cells]
    assert (cells[0], cells[-1]) == ((0, 0), (n - 1, m - 1))
    assert {(b[0] - a[0], b[1] - a[1]) for a, b in pairwise(cells)} <= {(1, 1), (1, 0), (0, 1)}
    walked = sum(float(np.linalg.norm(one[i] - other[j])) for i, j in cells) / (n + m)
    assert walked == pytest.approx(path.cost)
    assert path.cost == pytest.approx(naive_cost(one, other))


@given(seed=st.integers(0, 10**6), n=lengths, m=lengths)
def test_exchanged_sequences_exchange_the_path(seed: int, n: int, m: int) -> None:
    one, other = random_walk(seed, n), random_walk(seed + 1, m)
    there, back = warping_path(one, other), warping_path(other, one)
    assert there.cost == pytest.approx(back.cost)
    np.testing.assert_array_equal(there.cells, back.cells[:, ::-1])


def test_the_cost_is_the_distance_of_searches() -> None:
    one, other = random_walk(1, 400, 82), random_walk(2, 311, 82)
    (distance,) = dtw_distances(one, [other])
    assert warping_path(one, other).cost == pytest.approx(distance, rel=1e-5)


def test_a_sequence_is_matched_with_itself_frame_by_frame() -> None:
    one = random_walk(3, 50)
    path = warping_path(one, one)
    assert path.cost == 0
    np.testing.assert_array_equal(path.cells, np.repeat(np.arange(50)[:, None], 2, axis=1))


def test_a_slower_copy_waits_at_each_frame() -> None:
    one = random_walk(4, 20)
    path = warping_path(one, np.repeat(one, 3, axis=0))
    assert path.cost == 0
    np.testing.assert_array_equal(path.cells[:, 0], np.repeat(np.arange(20), 3))


def test_an_empty_sequence_has_no_path() -> None:
    with pytest.raises(ValueError, match="empty"):
        warping_path(np.zeros((0, 3)), np.zeros((4, 3)))
