"""Cursors come back as they were given out, and no others are taken."""

from __future__ import annotations

import base64
import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.errors import BadField
from app.search.cursor import Position, decode, digest, encode

QUESTION = digest("clip_1", "fused")


@given(
    rank=st.integers(0, 10**9),
    distance=st.floats(0, 1e9),
    clip_id=st.text(max_size=40),
)
def test_a_cursor_holds_its_position(rank: int, distance: float, clip_id: str) -> None:
    position = Position(rank, distance, clip_id)
    assert decode(encode(position, QUESTION), QUESTION) == position


def test_a_cursor_of_another_question_is_refused() -> None:
    cursor = encode(Position(1, 0.5, "clip_1"), QUESTION)
    with pytest.raises(BadField, match="cursor"):
        decode(cursor, digest("clip_1", "vector"))


@given(st.text(max_size=80))
def test_no_text_makes_anything_but_a_refusal(text: str) -> None:
    with pytest.raises(BadField) as refused:
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
        {"a": 1},
        7,
    ],
)
def test_a_forged_cursor_is_refused(body: object) -> None:
    forged = base64.urlsafe_b64encode(json.dumps(body).encode()).decode().rstrip("=")
    with pytest.raises(BadField):
        decode(forged, QUESTION)
