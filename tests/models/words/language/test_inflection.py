"""Forms of English words find the word that is known, and no other."""

from __future__ import annotations

import pytest

from app.models.words.language.inflection import base_form, base_forms

_WORDS = (
    "walk jump wave jog carry kick run stand kneel sit hop bus wing left leave leg left_leg "
    "dance swim slow punch lie die bow high_kick box dress"
)
WORDS = frozenset(_WORDS.split())


@pytest.mark.parametrize(
    ("form", "base"),
    [
        ("walking", "walk"),
        ("jumps", "jump"),
        ("jumped", "jump"),
        ("waving", "wave"),
        ("waves", "wave"),
        ("jogging", "jog"),
        ("jogger", "jog"),
        ("carries", "carry"),
        ("carried", "carry"),
        ("ran", "run"),
        ("running", "run"),
        ("stood", "stand"),
        ("knelt", "kneel"),
        ("hopped", "hop"),
        ("dancers", "dance"),
        ("swum", "swim"),
        ("slowly", "slow"),
        ("punches", "punch"),
        ("boxing", "box"),
        ("lying", "lie"),
        ("left_legs", "left_leg"),
        ("high_kicks", "high_kick"),
        ("bus", "bus"),
        ("wing", "wing"),
        ("left", "left"),
        ("dress", "dress"),
    ],
)
def test_a_form_finds_its_word(form: str, base: str) -> None:
    assert base_form(form, WORDS.__contains__) == base


@pytest.mark.parametrize("word", ["singing", "bing", "ss", "s", "ed", "", "zebra", "walkable"])
def test_a_form_of_an_unknown_word_has_no_base_form(word: str) -> None:
    assert base_form(word, WORDS.__contains__) is None


def test_no_candidate_is_empty_or_the_word_itself() -> None:
    for word in (*WORDS, "ing", "er", "aes", "left_legs_ing"):
        assert word not in base_forms(word)
        assert all(base_forms(word))
