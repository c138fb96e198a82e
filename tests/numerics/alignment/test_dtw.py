"""Dynamic time warping against its slow, obvious twin."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.deadline import Deadline, within
from app.errors import ClientLeft
from app.numerics.alignment import cost_tables, dtw
from app.numerics.alignment.dtw import dtw_distances
from app.numerics.arrays import FloatArray


def naive_dtw(a: FloatArray, b: FloatArray) -> float:
    a, b = a.reshape(len(a), -1), b.reshape(len(b), -1)
    n, m = len(a), len(b)
    table = np.full((n + 1, m + 1), np.inf)
    table[0, 0] = 0.0
    for i in range(n):
        for j in range(m):
            best = min(table[i, j], table[i, j + 1], table[i + 1, j])
            table[i + 1, j + 1] = np.linalg.norm(a[i] - b[j]) + best
    return float(table[n, m])


@given(
    n=st.integers(1, 12),
    lengths=st.lists(st.integers(1, 14), min_size=1, max_size=6),
    dimensions=st.sampled_from([1, 2, 5]),
    seed=st.integers(0, 10_000),
)
@settings(max_examples=150, deadline=None)
def test_a_batch_equals_a_naive_computation(
    n: int, lengths: list[int], dimensions: int, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    query = rng.normal(size=(n, dimensions))
    candidates = [rng.normal(size=(m, dimensions)) for m in lengths]
    expected = [naive_dtw(query, c) / (n + len(c)) for c in candidates]
    np.testing.assert_allclose(dtw_distances(query, candidates), expected, rtol=1e-4, atol=1e-6)


def test_many_batches_give_what_one_gives(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(1)
    query = rng.normal(size=(9, 3))
    candidates = [rng.normal(size=(m, 3)) for m in rng.integers(1, 30, size=40)]
    at_once = dtw_distances(query, candidates)
    for module in (cost_tables, dtw):
        monkeypatch.setattr(module, "MAX_CELLS_AT_ONCE", 500)
    np.testing.assert_allclose(dtw_distances(query, candidates), at_once, rtol=1e-5)


@given(
    n=st.integers(1, 40),
    m=st.integers(1, 40),
    rows=st.integers(1, 9),
    dimensions=st.sampled_from([1, 3]),
    seed=st.integers(0, 10_000),
)
@settings(max_examples=100, deadline=None)
def test_a_long_pair_in_strips_equals_a_naive_computation(
    n: int, m: int, rows: int, dimensions: int, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    a, b = rng.normal(size=(n, dimensions)), rng.normal(size=(m, dimensions))
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(dtw, "MAX_CELLS_AT_ONCE", 1)
        patched.setattr(dtw, "MIN_ROWS", rows)
        patched.setattr(dtw, "MAX_ROWS", rows)
        found = dtw_distances(a, [b], per_step=False)[0]
    assert found == pytest.approx(naive_dtw(a, b), rel=1e-4, abs=1e-6)


def test_strips_of_one_dimension_change_no_bit() -> None:
    rng = np.random.default_rng(5)
    a, b = rng.normal(size=2600), rng.normal(size=700)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(dtw, "MAX_CELLS_AT_ONCE", 10**9)
        whole = dtw_distances(a, [b])[0]
    assert dtw_distances(a, [b])[0] == whole


def test_the_memory_of_a_long_pair_grows_with_its_length() -> None:
    a, b = np.sin(np.arange(40_000) / 50), np.sin(np.arange(400) / 50)
    tracemalloc.start()
    dtw_distances(a, [b])[0]
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 16 * 2**20, "the table of costs alone has 64 MB"


def test_the_computation_stops_when_the_client_left() -> None:
    a, b = np.zeros(20_000), np.zeros(20_000)
    abandoned = Deadline()
    abandoned.abandon()
    with within(abandoned), pytest.raises(ClientLeft):
        dtw_distances(a, [b])[0]


def test_the_cost_of_a_pair_does_not_depend_on_the_other_candidates() -> None:
    rng = np.random.default_rng(3)
    query = rng.normal(size=(41, 82)).astype(np.float32)
    lengths = rng.integers(1, 90, size=60)
    candidates = [rng.normal(size=(m, 82)).astype(np.float32) for m in lengths]
    together = dtw_distances(query, candidates)
    alone = [float(dtw_distances(query, [one])[0]) for one in candidates]
    some = dtw_distances(query, candidates[20:31])
    assert together.tolist() == alone
    assert together[20:31].tolist() == some.tolist()


def test_a_sequence_has_distance_zero_to_itself_and_distance_is_symmetric() -> None:
    rng = np.random.default_rng(2)
    a, b = rng.normal(size=(20, 82)).astype(np.float32), rng.normal(size=(31, 82))
    from_a, from_b = dtw_distances(a, [a, b]), dtw_distances(b, [a])
    assert from_a[0] == pytest.approx(0.0, abs=1e-6)
    assert from_a[1] == pytest.approx(from_b[0])


def test_one_dimension_may_be_a_flat_array_and_is_exact() -> None:
    a, b = np.array([0.0, 1.0, 2.0]), np.array([0.0, 0.0, 1.0, 2.0, 2.0])
    assert dtw_distances(a, [b]) == 0.0
    assert dtw_distances(a, [b + 1], per_step=False) == pytest.approx(naive_dtw(a, b + 1))


def test_no_candidates_give_no_distances_and_empty_ones_are_refused() -> None:
    assert dtw_distances(np.zeros((3, 2)), []).shape == (0,)
    with pytest.raises(ValueError, match="empty"):
        dtw_distances(np.zeros((3, 2)), [np.zeros((0, 2))])
