"""A cursor holds the values that were written; any other text is refused."""

from __future__ import annotations

import base64
import json
import math
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.errors import PageNotFound
from app.store.database import cursor_codec
from app.store.database.cursor_codec import MAX_CURSOR_LENGTH, NotACursor, decode, encode
from app.store.database.paging import Position, read_cursor, write_cursor

NUMBERS = st.integers() | st.floats() | st.sampled_from([10**400, -(10**400), 10**4000])
ANY_JSON = st.recursive(
    st.none() | st.booleans() | NUMBERS | st.text() | st.just("\ud800") | st.just("name"),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=10,
)


@given(
    st.lists(
        st.none() | st.text(max_size=40) | st.floats(allow_nan=False, allow_infinity=False),
        max_size=7,
    )
)
def test_a_cursor_holds_its_values(values: list[Any]) -> None:
    assert decode(encode(values)) == values


@settings(max_examples=300, deadline=None, derandomize=True, database=None)
@given(ANY_JSON)
def test_any_json_is_a_value_of_the_kind_or_refused(value: Any) -> None:
    for read in (
        cursor_codec.as_text,
        cursor_codec.as_number,
        lambda given: cursor_codec.as_count(given, 10),
    ):
        try:
            found = read(value)
        except NotACursor:
            continue
        assert found == value
        assert isinstance(found, str) or math.isfinite(found)


@settings(max_examples=300, deadline=None, derandomize=True, database=None)
@given(
    content=st.binary()
    | st.one_of(ANY_JSON, st.lists(ANY_JSON, max_size=4).map(lambda some: ["name", *some]))
    .map(json.dumps)
    .map(str.encode),
    kind=st.sampled_from([str, float]),
)
def test_any_content_is_a_position_of_a_list_or_refused(content: bytes, kind: type) -> None:
    cursor = base64.urlsafe_b64encode(content).decode()
    try:
        position = read_cursor(cursor, "name", kind)
    except PageNotFound:
        return
    assert isinstance(position, Position)
    assert read_cursor(write_cursor("name", position), "name", kind) == position


@pytest.mark.parametrize(
    "text",
    [
        "",
        "a",
        "ä",
        "W10.",  # a character that is none of base64
        "W10 ",
        "x" * (MAX_CURSOR_LENGTH + 1),
        base64.urlsafe_b64encode(b"[" * 3000).decode(),
        base64.urlsafe_b64encode(b"{}").decode(),
        base64.urlsafe_b64encode(b"[" + b"9" * 3000 + b"]").decode()[:-8],
    ],
)
def test_texts_that_are_no_cursor_are_refused(text: str) -> None:
    with pytest.raises(NotACursor):
        decode(text)
