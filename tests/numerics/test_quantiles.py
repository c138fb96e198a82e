from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.numerics.quantiles import median, quantile, quantiles, quantiles_of_sorted

SHARES = (0.0, 0.01, 0.02, 0.05, 0.2, 0.5, 0.75, 0.9, 0.95, 0.98, 1.0)


@pytest.mark.parametrize("count", [1, 2, 3, 10, 101, 176])
@pytest.mark.parametrize("rest", [(), (3,), (2, 3)])
def test_they_are_those_of_numpy_bit_for_bit(count: int, rest: tuple[int, ...]) -> None:
    values = np.random.default_rng(count).normal(size=(count, *rest))
    np.testing.assert_array_equal(median(values), np.median(values, axis=0))
    np.testing.assert_array_equal(quantiles(values, SHARES), np.quantile(values, SHARES, axis=0))
    for share in SHARES:
        np.testing.assert_array_equal(quantile(values, share), np.quantile(values, share, axis=0))


def test_equal_values_have_themselves_as_quantiles() -> None:
    assert quantiles(np.full(7, 0.1), SHARES) == [0.1] * len(SHARES)


@given(
    count=st.integers(1, 40), seed=st.integers(0, 99),
    shares=st.lists(st.floats(0.0, 1.0), min_size=1, max_size=4),
)  # fmt: skip
def test_quantiles_of_sorted_rows_are_those_of_numpy(
    count: int, seed: int, shares: list[float]
) -> None:
    values = np.random.default_rng(seed).normal(size=(len(shares), 3, count))
    found = quantiles_of_sorted(np.sort(values, axis=-1), np.array(shares))
    for rows, share, ours in zip(values, shares, found, strict=True):
        np.testing.assert_array_equal(ours, np.quantile(rows, share, axis=1))
