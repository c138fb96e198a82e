"""Plain decimal numbers, read many at once, agree with Python's reading of each number."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.formats.common.decimals import plain_table

PLAIN = st.from_regex(r"-?([0-9]{1,7}(\.[0-9]{0,6})?|\.[0-9]{1,7})", fullmatch=True)
SMALL = st.from_regex(r"-?[0-9]{1,7}(\.[0-9]{0,6})?[eE]-(0[0-9]|1[0-6])", fullmatch=True)
LARGE = st.from_regex(r"-?[0-9]{1,5}\.[0-9]{6,8}[eE]\+0[0-6]", fullmatch=True)
WORDS = st.text(alphabet="0123456789.-e+", min_size=1, max_size=7)


@given(st.lists(st.tuples(PLAIN, PLAIN | SMALL, PLAIN | LARGE), min_size=1, max_size=6))
def test_each_number_is_read_as_python_reads_it(rows: list[tuple[str, str, str]]) -> None:
    lines = ["\t ".join(row).encode() for row in rows]
    table = plain_table(lines, 3)
    assert table is not None
    expected = np.array([[float(word) for word in row] for row in rows])
    np.testing.assert_array_equal(table, expected)
    np.testing.assert_array_equal(np.signbit(table), np.signbit(expected))


@given(st.lists(st.tuples(WORDS, WORDS), min_size=1, max_size=4))
def test_text_that_is_not_a_number_is_never_read_as_a_number(rows: list[tuple[str, str]]) -> None:
    table = plain_table([" ".join(row).encode() for row in rows], 2)
    if table is not None:
        np.testing.assert_array_equal(table, [[float(word) for word in row] for row in rows])


NOT_PLAIN = """
1 2e3; 1 2e+03 4; 1 1e-0x; 1 1e-1; e-05 1; 1 1e-023; 1 1.5e-23; 1 1.5e+02
1 nan; 1 +2; 1,5 2; 1_0 2; 1 2 3; 1; 1-2 .; .-5 1; 1 -; - 1 -1; 1.2.3 1; 1 --5; 1 -.
1 1234567890123456; \u0661 1
"""


@pytest.mark.parametrize("line", NOT_PLAIN.strip().replace("\n", "; ").split("; "))
def test_numbers_that_are_not_plain_are_left_to_the_slow_reader(line: str) -> None:
    assert plain_table([line.encode()], 2) is None


def test_numbers_of_two_lines_are_not_joined() -> None:
    assert plain_table([b"1 2 3", b"4"], 2) is None


def test_no_lines_give_no_table() -> None:
    assert plain_table([], 3) is None
