"""A sentence is reduced to the words that matter; what is not wanted is told apart."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.models.words.language.inflection import base_form
from app.models.words.language.sentence import QueryWords, read_query

_LABELS = "old wave left hand left_leg kick walk turn high_kick up"
LABELS = frozenset(_LABELS.split())


def _is_word(word: str) -> bool:
    return base_form(word, LABELS.__contains__) is not None


@pytest.mark.parametrize(
    ("texts", "wanted", "excluded"),
    [
        (["an old man waves with his left hand"], ("old", "waves", "left", "hand"), ()),
        (["The man's kicking with the left leg."], ("kicking", "left_leg"), ()),
        (["kick", "left leg"], ("kick", "left_leg"), ()),
        (["left", "leg"], ("left", "leg"), ()),
        (["High-Kick!"], ("high_kick",), ()),
        (["walk -turn"], ("walk",), ("turn",)),
        (["walk", "-turning"], ("walk",), ("turning",)),
        (["walking without turning"], ("walking",), ("turning",)),
        (["someone flies up"], ("flies", "up"), ()),
        (["the"], ("the",), ()),
        (["the man"], (), ()),
        (["walk walk", "walk"], ("walk",), ()),
        (["-left leg kick"], ("kick",), ("left_leg",)),
        (["  ", "!?"], (), ()),
    ],
)
def test_what_is_asked(
    texts: list[str], wanted: tuple[str, ...], excluded: tuple[str, ...]
) -> None:
    assert read_query(texts, _is_word) == QueryWords(wanted, excluded)


@given(st.lists(st.text(max_size=40), max_size=4))
def test_any_text_is_read(texts: list[str]) -> None:
    asked = read_query(texts, _is_word)
    assert all(asked.included)
    assert all(asked.excluded)
    assert len(set(asked.included)) == len(asked.included)
