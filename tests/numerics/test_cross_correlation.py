"""The largest cross-correlation, against numpy's direct one."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.numerics import cross_correlation
from app.numerics.cross_correlation import max_cross_correlation, max_cross_correlations


@given(
    n=st.integers(1, 20),
    lengths=st.lists(st.integers(1, 30), min_size=1, max_size=5),
    seed=st.integers(0, 10_000),
)
@settings(max_examples=100, deadline=None)
def test_equals_the_direct_one(n: int, lengths: list[int], seed: int) -> None:
    rng = np.random.default_rng(seed)
    query, candidates = rng.normal(size=n), [rng.normal(size=m) for m in lengths]
    direct = [np.correlate(query, c, "full").max(initial=0.0) for c in candidates]
    np.testing.assert_allclose(max_cross_correlations(query, candidates), direct, atol=1e-10)


def test_padding_the_shorter_changes_nothing() -> None:
    rng = np.random.default_rng(0)
    a, b = rng.random(13), rng.random(20)
    assert max_cross_correlation(np.pad(a, (0, 7)), b) == pytest.approx(max_cross_correlation(a, b))


def test_a_unit_vector_meets_itself_at_one_wherever_it_begins() -> None:
    a = np.random.default_rng(1).random(50)
    a /= np.linalg.norm(a)
    assert max_cross_correlation(a, a) == pytest.approx(1.0)
    assert max_cross_correlation(a, np.pad(a, (9, 3))) == pytest.approx(1.0)


def test_many_batches_give_what_one_gives(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(2)
    query, candidates = rng.random(30), [rng.random(m) for m in rng.integers(1, 90, size=20)]
    at_once = max_cross_correlations(query, candidates)
    monkeypatch.setattr(cross_correlation, "BATCH", 3)
    np.testing.assert_allclose(max_cross_correlations(query, candidates), at_once)


def test_nothing_correlates_with_nothing() -> None:
    assert max_cross_correlations(np.ones(3), []).shape == (0,)
    assert max_cross_correlation(np.ones(3), np.zeros(0)) == 0.0
