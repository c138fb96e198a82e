"""Rounding of whole arrays is rounding of each number's text."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.numerics.rounding import rounded

numbers = st.floats(min_value=-1e250, max_value=1e250).filter(lambda x: x == 0 or abs(x) > 1e-250)


@given(st.lists(numbers, max_size=20), st.integers(1, 12))
def test_each_number_has_few_digits_and_is_near(values: list[float], digits: int) -> None:
    found = rounded(np.array(values), digits)
    for value, one in zip(values, found.tolist(), strict=True):
        assert one == pytest.approx(value, rel=0.51 * 10.0 ** (1 - digits), abs=0.0)
        assert float(f"{one:.{digits}g}") == pytest.approx(one, rel=1e-14, abs=0.0)


def test_what_is_written_is_short() -> None:
    values = np.array([0.1234567, 12345.678, -3.14159265, 0.00098765432, 1234567.0, 1000.0, 0.0])
    written = [str(value) for value in rounded(values, 4).tolist()]
    assert written == ["0.1235", "12350.0", "-3.142", "0.0009877", "1235000.0", "1000.0", "0.0"]


def test_numbers_that_have_no_digits_stay() -> None:
    found = rounded(np.array([np.nan, 0.0, 5e-324, 1.7e308]), 5)
    assert np.isnan(found[0])
    assert np.isfinite(found[1:]).all()
