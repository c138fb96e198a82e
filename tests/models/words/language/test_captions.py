"""Captions teach the words that they say about a clip."""

from __future__ import annotations

from app.models.words.language.captions import caption_words, with_caption_words


def test_a_caption_says_its_content_words() -> None:
    said = caption_words(["A man is walking slowly, without kicking.", "He takes a step"])
    assert said == ("walk", "slow", "step")
    assert caption_words(["the man", ""]) == ()


def test_known_and_repeated_words_teach() -> None:
    sets = [("zumba",), (), (), (), ("walk",)]
    captions = [
        ("he kicks a qwert", "the zork"), ("zork", "qwert"), ("zork",), ("a zumba",),
        ("he walks",),
    ]  # fmt: skip
    assert with_caption_words(sets, captions) == [
        ("zumba", "kick", "zork"), ("zork",), ("zork",), ("zumba",), ("walk",),
    ]  # fmt: skip
    assert with_caption_words([("a",), ()], [(), ()]) == [("a",), ()]
