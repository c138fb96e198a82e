"""The largest cross-correlation, against a slow obvious one and numpy's direct one."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.numerics.alignment import cross_correlation
from app.numerics.alignment.cross_correlation import (
    max_contained_cosines,
    max_cross_correlations,
    max_cross_correlations_of_rows,
)
from app.numerics.arrays import FloatArray


def max_cross_correlation(a: FloatArray, b: FloatArray) -> float:
    return float(max_cross_correlations(a, [b])[0])


def slow_twin(a: FloatArray, b: FloatArray) -> float:
    """Sun's words: zero-pad the shorter to the length of the longer, then every lag."""
    length = max(len(a), len(b))
    a, b = (np.pad(sequence, (0, length - len(sequence))) for sequence in (a, b))
    sums = [
        sum(a[i + lag] * b[i] for i in range(length) if 0 <= i + lag < length)
        for lag in range(1 - length, length)
    ]
    return float(max(sums))


@given(n=st.integers(1, 12), m=st.integers(1, 12), seed=st.integers(0, 10_000))
@settings(max_examples=60, deadline=None)
def test_equals_a_slow_computation_on_vectors_of_volumes(n: int, m: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    a, b = rng.random(n), rng.random(m)
    assert max_cross_correlation(a, b) == pytest.approx(slow_twin(a, b), abs=1e-12)


@given(
    n=st.integers(1, 20),
    lengths=st.lists(st.integers(1, 200), min_size=1, max_size=9),
    seed=st.integers(0, 10_000),
)
@settings(max_examples=100, deadline=None)
def test_equals_the_direct_computation(n: int, lengths: list[int], seed: int) -> None:
    rng = np.random.default_rng(seed)
    query, candidates = rng.normal(size=n), [rng.normal(size=m) for m in lengths]
    direct = [np.correlate(query, c, "full").max(initial=0.0) for c in candidates]
    np.testing.assert_allclose(max_cross_correlations(query, candidates), direct, atol=1e-10)


@given(n=st.integers(1, 20), m=st.integers(1, 20), seed=st.integers(0, 10_000))
@settings(max_examples=60, deadline=None)
def test_rows_of_one_length_give_the_same(n: int, m: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    query, rows = rng.normal(size=n), rng.normal(size=(4, m))
    np.testing.assert_allclose(
        max_cross_correlations_of_rows(query, rows),
        max_cross_correlations(query, list(rows)),
        atol=1e-12,
    )


def test_padding_the_shorter_changes_nothing() -> None:
    rng = np.random.default_rng(0)
    a, b = rng.random(13), rng.random(20)
    assert max_cross_correlation(np.pad(a, (0, 7)), b) == pytest.approx(max_cross_correlation(a, b))


def test_a_shifted_unit_vector_has_correlation_one() -> None:
    a = np.random.default_rng(1).random(50)
    a /= np.linalg.norm(a)
    assert max_cross_correlation(a, a) == pytest.approx(1.0)
    assert max_cross_correlation(a, np.pad(a, (9, 3))) == pytest.approx(1.0)


def test_many_batches_give_what_one_gives(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(2)
    query, candidates = rng.random(30), [rng.random(m) for m in rng.integers(1, 900, size=40)]
    as_usual = max_cross_correlations(query, candidates)
    monkeypatch.setattr(cross_correlation, "MAX_WASTE", 100.0)
    np.testing.assert_allclose(max_cross_correlations(query, candidates), as_usual)
    monkeypatch.setattr(cross_correlation, "MAX_CELLS_AT_ONCE", 1)
    np.testing.assert_allclose(max_cross_correlations(query, candidates), as_usual)


def test_empty_sequences_have_correlation_zero() -> None:
    assert max_cross_correlations(np.ones(3), []).shape == (0,)
    assert max_cross_correlation(np.ones(3), np.zeros(0)) == 0.0
    assert max_cross_correlation(np.zeros(0), np.ones(3)) == 0.0
    assert max_cross_correlations(np.ones(3), [np.zeros(0), np.ones(2)]).tolist() == [0.0, 2.0]
    assert max_cross_correlations_of_rows(np.ones(3), np.zeros((0, 3))).shape == (0,)
    assert max_cross_correlations_of_rows(np.ones(3), np.zeros((2, 0))).tolist() == [0.0, 0.0]


def test_the_cosine_of_a_part_is_one_at_any_length_and_gain() -> None:
    rng = np.random.default_rng(7)
    long = 1 + 0.2 * rng.random(90)
    parts = [2.0 * long[10:40], long[5:6], long, long[:0]]
    np.testing.assert_allclose(max_contained_cosines(long, parts), [1, 1, 1, 0], atol=1e-9)
    for part in parts:
        assert max_contained_cosines(part, [long]) == max_contained_cosines(long, [part])


def test_contained_cosines_equal_a_loop_over_lags() -> None:
    rng = np.random.default_rng(8)
    query, candidates = rng.normal(size=20), [rng.normal(size=n) for n in (3, 20, 47)]
    for candidate, found in zip(candidates, max_contained_cosines(query, candidates), strict=True):
        short, long = sorted((query, candidate), key=len)
        pieces = [long[k : k + len(short)] for k in range(len(long) - len(short) + 1)]
        cosines = [p @ short / np.linalg.norm(p) / np.linalg.norm(short) for p in pieces]
        assert found == pytest.approx(max(cosines), abs=1e-9)
