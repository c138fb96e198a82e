"""Words that no clip carries find what the library calls the same."""

from __future__ import annotations

import pytest

from app.models.words.language.lexicon import likeness
from app.models.words.language.meaning import neighbors
from app.models.words.language.wordnet import Meanings, is_installed

LIBRARY = ("bow", "elderly", "jump", "kick", "punch", "run", "sit", "tired", "walk", "wave")


@pytest.mark.parametrize(
    ("word", "ours"),
    [
        ("sprint", "run"),
        ("sprinting", "run"),
        ("leap", "jump"),
        ("stroll", "walk"),
        ("aged", "elderly"),
        ("exhausted", "tired"),
        ("curtsy", "bow"),
        ("boots", "kick"),
    ],
)
def test_the_lexicon_has_the_words_of_movement(word: str, ours: str) -> None:
    assert neighbors(word, LIBRARY, {})[0].word == ours


def test_an_unknown_word_has_no_neighbors() -> None:
    assert neighbors("zebra", LIBRARY, {}) == ()
    assert neighbors("sprint", (), {}) == ()


def test_likeness_is_symmetric_and_the_same_word_is_the_nearest() -> None:
    words = ("sprint", "run", "jog", "bye", "wave", "zebra", "punch", "kick")
    for one in words:
        assert likeness(one, one) == 1.0
        for other in words:
            assert likeness(one, other) == likeness(other, one)
            assert one == other or likeness(one, other) < 1.0


def test_wordnet_is_used_for_words_that_the_lexicon_lacks() -> None:
    related = {"canter": {"run": 0.65, "walk": 0.5}, "sprint": {"walk": 0.9}}
    assert [near.word for near in neighbors("canter", LIBRARY, related)] == ["run"]
    assert neighbors("cantering", LIBRARY, related)[0].word == "run"
    assert neighbors("sprint", LIBRARY, related)[0].word == "run"


def test_words_that_a_library_no_longer_has_are_dropped() -> None:
    before = Meanings(
        ("run", "walk"), {"canter": {"run": 0.6, "walk": 0.5}, "amble": {"walk": 0.8}}
    )
    after = before.of(("run", "jump"), look_up=False)
    assert after == Meanings(("run",), {"canter": {"run": 0.6}})
    assert Meanings.from_meta(after.to_meta()) == after
    assert Meanings.from_meta({}) == Meanings()
    assert Meanings.from_meta({**after.to_meta(), "version": 1}) == Meanings()


@pytest.mark.parametrize("word", ["falling", "take", "shower", "box_office", "shiver"])
def test_a_word_that_the_lexicon_keeps_apart_stays_unknown(word: str) -> None:
    assert neighbors(word, LIBRARY, {"fall": {"run": 0.65}, "shower": {"kick": 0.1}}) == ()


@pytest.mark.slow
@pytest.mark.skipif(not is_installed(), reason="the extra `words` is not installed")
def test_wordnet_has_more_words() -> None:
    """WordNet takes seconds to load."""
    related = Meanings().of(LIBRARY, look_up=True).related
    for word, ours in {
        "plod": "walk",
        "lope": "run",
        "hurdle": "jump",
        "perambulate": "walk",
        "flap": "wave",
    }.items():
        found = [near.word for near in neighbors(word, LIBRARY, related)]
        assert ours in found, (word, found)
    others = ("left", "arm", "guide", "strike", "hand", "turn")
    senseless = Meanings().of(others, look_up=True).related
    for word in ("make", "floor", "shower", "take", "weapon", "leave", "music", "give", "house"):
        assert neighbors(word, others, senseless) == (), word
