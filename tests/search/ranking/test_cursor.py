"""Cursors come back as they were given out, and no others are taken."""

from __future__ import annotations

import base64
import json
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.errors import PageNotFound
from app.search.ranking.cursor import MAX_RANK, Anchor, Position, decode, digest, encode

QUESTION = digest("clip_1", "fused")


@given(
    rank=st.integers(0, 10**9),
    distance=st.floats(0, 1e9),
    clip_id=st.text(max_size=40),
    anchor=st.none()
    | st.builds(
        Anchor,
        st.floats(0, 1e9),
        st.just("clip"),
        st.none() | st.floats(0, 1e9),
        st.none() | st.tuples(st.floats(0, 1e9), st.just("guest")),
    ),
    scales=st.lists(st.floats(1e-9, 1e9), max_size=40).map(tuple),
)
def test_a_cursor_contains_its_position(
    rank: int, distance: float, clip_id: str, anchor: Anchor | None, scales: tuple[float, ...]
) -> None:
    position = Position(rank, distance, clip_id, anchor, scales)
    assert decode(encode(position, QUESTION), QUESTION) == position


def test_a_cursor_of_another_query_is_refused() -> None:
    cursor = encode(Position(1, 0.5, "clip_1"), QUESTION)
    with pytest.raises(PageNotFound):
        decode(cursor, digest("clip_1", "vector"))


@given(st.text(max_size=80))
def test_any_other_text_is_refused(text: str) -> None:
    with pytest.raises(PageNotFound) as refused:
        decode(text, QUESTION)
    assert refused.value.places[0].location == "cursor"


@pytest.mark.parametrize(
    "body",
    [
        [QUESTION, "1", 0.5, "a"],
        [QUESTION, True, 0.5, "a"],
        [QUESTION, -1, 0.5, "a"],
        [QUESTION, 1, "x", "a"],
        [QUESTION, 1, float("nan"), "a"],
        [QUESTION, 1, 0.5, 7],
        [QUESTION, 1, 0.5],
        [QUESTION, 1, 10**400, "a"],
        [QUESTION, 10**400, 0.5, "a"],
        [QUESTION, 1, True, "a"],
        [QUESTION, 1, 0.5, "\ud800"],
        [QUESTION, 1, 0.5, "a", [0.0]],
        [QUESTION, 1, 0.5, "a", ["x"]],
        [QUESTION, 1, 0.5, "a", [float("inf")]],
        [QUESTION, 1, 0.5, "a", 10**400, "a", None],
        [QUESTION, 1, 0.5, "a", 0.5, "a", -(10**400)],
        {"a": 1},
        7,
    ],
)
def test_a_forged_cursor_is_refused(body: object) -> None:
    forged = base64.urlsafe_b64encode(json.dumps(body).encode()).decode().rstrip("=")
    with pytest.raises(PageNotFound):
        decode(forged, QUESTION)


NUMBERS = st.integers() | st.floats() | st.sampled_from([10**400, -(10**400), 10**4000])
ANY_JSON = st.recursive(
    st.none() | st.booleans() | NUMBERS | st.text() | st.just("\ud800") | st.just(QUESTION),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=10,
)
FORGED = st.lists(NUMBERS | st.text() | ANY_JSON, max_size=7).map(lambda rest: [QUESTION, *rest])


@settings(max_examples=400, deadline=None, derandomize=True, database=None)
@given(
    content=(ANY_JSON | FORGED).map(json.dumps).map(str.encode) | st.binary(), cut=st.integers(0, 3)
)
def test_a_cursor_with_any_content_is_a_position_or_is_refused(content: bytes, cut: int) -> None:
    cursor = base64.urlsafe_b64encode(content).decode()
    for text in (cursor, cursor.rstrip("="), cursor[: len(cursor) - cut], "[" * 990):
        try:
            position = decode(text, QUESTION)
        except PageNotFound:
            continue
        assert math.isfinite(position.distance)
        assert 0 <= position.rank <= MAX_RANK


def test_a_cursor_that_is_nested_too_deeply_is_refused() -> None:
    for content in (b"[" * 100_000, b'{"a":' * 100_000, b"9" * 10_000):
        with pytest.raises(PageNotFound):
            decode(base64.urlsafe_b64encode(content).decode(), QUESTION)
