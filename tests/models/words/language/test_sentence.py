"""A sentence is read into words to find and words to exclude."""

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
    ("texts", "included", "excluded"),
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
        (["she takes a step"], ("step",), ()),
        (["somebody is making turns"], ("turns",), ()),
        (["takes"], ("takes",), ()),
        (["the"], ("the",), ()),
        (["the man"], (), ()),
        (["walk walk", "walk"], ("walk",), ()),
        (["-left leg kick"], ("kick",), ("left_leg",)),
        (["  ", "!?"], (), ()),
    ],
)
def test_queries_are_read_into_words(
    texts: list[str], included: tuple[str, ...], excluded: tuple[str, ...]
) -> None:
    assert read_query(texts, _is_word) == QueryWords(included, excluded)


def test_a_noun_after_an_article_is_a_thing() -> None:
    for text, things in {
        "lifts a box": {"box"},
        "boxes with a kick": set(),
        "the man rows": set(),
        "two rows of his boots": {"boots"},
    }.items():
        assert read_query([text], _is_word).things == things


@given(st.lists(st.text(max_size=40), max_size=4))
def test_any_text_is_read(texts: list[str]) -> None:
    words = read_query(texts, _is_word)
    assert all(words.included)
    assert all(words.excluded)
    assert len(set(words.included)) == len(words.included)
