"""What a query means to a library is told: known, in other words, unknown, to be left out."""

from __future__ import annotations

import pytest

from app.models.words.query import understand
from app.models.words.vocabulary import WordVocabulary

VOCABULARY = WordVocabulary(("jump", "left_leg", "old", "run", "walk", "wave"))


def test_words_are_separated() -> None:
    asked = understand(["an old man sprints", "zebra", "-jumping", "-gnu"], VOCABULARY, {})
    assert asked.weights["old"] == 1.0
    assert 0.5 <= asked.weights["run"] < 1.0
    assert set(asked.weights) == {"old", "run"}
    assert asked.excluded == ("jump",)
    assert asked.unknown == ("zebra", "gnu")
    assert asked.expanded == {"sprints": ("run",)}


def test_a_word_of_the_query_has_more_weight_than_a_replacement() -> None:
    assert understand(["sprint", "run"], VOCABULARY, {}).weights == {"run": 1.0}


def test_an_inflected_word_is_the_word() -> None:
    asked = understand(["jumps"], VOCABULARY, {})
    assert asked.weights == {"jump": 1.0}
    assert asked.expanded == {"jumps": ("jump",)}


def test_a_phrase_is_one_word() -> None:
    assert understand(["left legs"], VOCABULARY, {}).weights == {"left_leg": 1.0}


@pytest.mark.parametrize(
    ("text", "items", "unknown"),
    [
        ("he falls down", [], ("falls",)),
        ("a person making a left turn", ["left moves", "turn (measured)"], ()),
        ("she takes a walk", ["walk"], ()),
        ("the floor of the shower", [], ("floor", "shower")),
        ("lifts a box", ["raise (measured)"], ("box",)),
        ("walks with both ankles", ["walk", "both feet move"], ()),
        ("waves the left wrist", ["wave", "left hand moves"], ()),
        ("moves the left leg", ["run", "walk", "left_leg"], ()),
        ("bends the waist", ["bend (measured)", "trunk leans"], ()),
        ("nodding his head", ["wave", "head moves"], ()),
    ],
)
def test_words_that_nobody_used(text: str, items: list[str], unknown: tuple[str, ...]) -> None:
    asked = understand([text], VOCABULARY, {})
    assert asked.unknown == unknown
    assert {name for item in asked.items for name in item} >= set(items) or not items
    assert bool(asked.items) == bool(items)


def test_how_far_a_word_was_stretched_is_told_and_lowers_its_weight() -> None:
    asked = understand(["a man sprints, marches, jumps and squats"], VOCABULARY, {})
    assert asked.expanded.keys() == asked.confidence.keys() == {
        "sprints", "marches", "jumps", "squats",
    }  # fmt: skip
    assert asked.confidence["jumps"] == 1.0
    assert asked.confidence["sprints"] == asked.weights["run"] == 0.9
    assert asked.confidence["marches"] == asked.weights["walk"] == 0.7
    assert asked.expanded["squats"] == ("squat (measured)",)
    assert 0.5 < asked.confidence["squats"] < 1.0
