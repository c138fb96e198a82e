"""Values of metadata: their texts, and cells of tables."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.store.clips.metadata_values import (
    as_cell,
    as_text,
    from_cell,
    from_text,
    kind_of,
    tidy_number,
)

NUMBERS = st.one_of(
    st.floats(allow_nan=False, allow_infinity=False), st.integers(-(2**53), 2**53)
).map(tidy_number)
TEXTS = st.one_of(
    st.text(min_size=1, max_size=20),
    st.sampled_from(("true", "FALSE", "007", "1.5", "1e5", '"', '"a"', '"1"', "-0", "1" * 30)),
)
VALUES = st.one_of(st.booleans(), NUMBERS, TEXTS)


@given(VALUES)
def test_a_value_survives_its_cell_and_its_text(value: Any) -> None:
    for again in (from_cell(as_cell(value)), from_text(kind_of(value).value, as_text(value))):
        assert again == value
        assert kind_of(again) is kind_of(value)


@pytest.mark.parametrize(
    ("cell", "value"),
    [
        ("1.50", 1.5),
        ("30", 30),
        ("-2e3", -2000),
        ("TRUE", True),
        ("false", False),
        ("007", "007"),
        ("9007199254740993", "9007199254740993"),
        ("1,5", "1,5"),
        ("nan", "nan"),
        ("1e999", "1e999"),
        ('"30"', "30"),
        ('say "hi"', 'say "hi"'),
        ('"broken', '"broken'),
    ],
)
def test_cells_are_read_as_people_mean_them(cell: str, value: Any) -> None:
    found = from_cell(cell)
    assert (found, type(found)) == (value, type(value))
