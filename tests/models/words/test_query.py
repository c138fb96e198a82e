"""What a query means to a library is told: known, in other words, unknown, to be left out."""

from __future__ import annotations

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
