"""Numbers in all forms are read, and other text is refused."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.errors import Unreadable
from app.formats.common.numbers import MAX_MAGNITUDE, excerpt, parse_numbers


@given(st.lists(st.floats(-MAX_MAGNITUDE, MAX_MAGNITUDE)), st.sampled_from([" ", "\t", ", ", ","]))
def test_any_numbers_are_read_back(numbers: list[float], between: str) -> None:
    text = between.join(map(repr, numbers)).encode()
    assert parse_numbers(text, 1, expected=len(numbers)).tolist() == numbers


@pytest.mark.parametrize(
    ("text", "expected", "numbers"),
    [
        (b"1,5 2,5", 2, [1.5, 2.5]),
        (b"1,5 2,5", 4, [1, 5, 2, 5]),
        (b"1,5", None, [1, 5]),
        (b"", 3, []),
        (b"+1 -.5 1.e2", 3, [1, -0.5, 100]),
    ],
)
def test_commas_separate_unless_points_are_expected(
    text: bytes, expected: int | None, numbers: list[float]
) -> None:
    assert parse_numbers(text, 1, expected).tolist() == numbers


@pytest.mark.parametrize(
    "bad", [b"nan", b"-inf", b"1e10", b"1_0", b"0x1", b"1.2.3", b"\xff", b"--1"]
)
def test_a_bad_number_is_reported_with_its_line(bad: bytes) -> None:
    with pytest.raises(Unreadable) as caught:
        parse_numbers(b"1 2 " + bad, 7)
    assert caught.value.places[0].location == "line 7"


def test_excerpts_are_short_and_printable() -> None:
    assert excerpt(b"a\x00b\xff") == "'a�b�'"
    assert len(excerpt(b"x" * 1000)) < 50
    assert np.all([char.isprintable() for char in excerpt(bytes(range(256)), 256)])
