from __future__ import annotations

import numpy as np
import pytest

from app.numerics.log_sums import log_sum, log_sums


@pytest.mark.parametrize("spread", [1.0, 100.0, 1e5])
def test_they_are_those_of_numpy(spread: float) -> None:
    logs = np.random.default_rng(0).normal(scale=spread, size=(20, 31))
    logs[:, 4:9] = -np.inf
    logs[3] = -np.inf
    starts = np.array([0, 1, 4, 8, 9, 30])
    expected = np.logaddexp.reduceat(logs, starts, axis=1)
    np.testing.assert_allclose(log_sums(logs, starts), expected, rtol=1e-13, atol=1e-13)
    np.testing.assert_allclose(log_sum(logs), np.logaddexp.reduce(logs, axis=1), rtol=1e-13)


def test_nothing_has_the_sum_zero() -> None:
    assert (log_sum(np.zeros((3, 0))) == -np.inf).all()
