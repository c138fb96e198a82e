"""No cell is a formula, and no text is lost by that."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.formats.csv.formulas import guarded, unguarded


@pytest.mark.parametrize("start", ["=", "+", "-", "@", "\t", "\r"])
def test_what_begins_a_formula_gets_an_apostrophe(start: str) -> None:
    assert guarded(f"{start}cmd|' /C calc'!A0") == f"'{start}cmd|' /C calc'!A0"


@given(st.text(st.sampled_from("'=+-@\t\r\na1 "), max_size=6))
def test_every_text_is_found_again(text: str) -> None:
    assert unguarded(guarded(text)) == text
    assert not guarded(text).startswith(("=", "+", "-", "@", "\t", "\r"))


def test_other_texts_stay_as_they_are() -> None:
    for text in ("", "walk", "'tis", "O'Neill", "3-2", "a=b"):
        assert guarded(text) == text
        assert unguarded(text) == text
