from __future__ import annotations

import numpy as np
import pytest

from app.numerics.quantiles import median, quantile, quantiles

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
