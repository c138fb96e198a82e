"""The words of captions: sentences that describe a clip teach words as labels do.

A caption is read like a query (`sentence`): function words, light verbs, and words after *without*
say nothing. Of the others, a clip gets those of our lexicon, and those that several clips have: a
name, or the color of a shirt, is in one caption only. Shapes: clips N.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from app.models.words.language.inflection import base_form
from app.models.words.language.lexicon import is_known
from app.models.words.language.normalize import normalize_words
from app.models.words.language.sentence import read_query

MIN_CLIPS = 3
"""Clips whose captions must have a word that is not in our lexicon."""


def caption_words(captions: Sequence[str]) -> tuple[str, ...]:
    """The distinct words that captions say about a clip, in their base forms if we know them."""
    read = read_query(captions, lambda _: False)
    return normalize_words(base_form(word, is_known) or word for word in read.included)


def with_caption_words(
    label_sets: Sequence[Sequence[str]], captions: Sequence[Sequence[str]]
) -> list[tuple[str, ...]]:
    """The label sets (N) with the words that the captions (N) of each clip add."""
    found = [caption_words(one) if one else () for one in captions]
    clips_of = Counter(word for words in found for word in words)
    labels = {word for words in label_sets for word in words}
    return [
        (*words, *(word for word in new if word not in words and _teaches(word, labels, clips_of)))
        for words, new in zip(label_sets, found, strict=True)
    ]


def _teaches(word: str, labels: set[str], clips_of: Counter[str]) -> bool:
    return word in labels or is_known(word) or clips_of[word] >= MIN_CLIPS
