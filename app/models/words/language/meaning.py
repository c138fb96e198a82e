"""Finds words of the library that are similar in meaning to a word that no clip has."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from app.models.words.language.inflection import base_forms
from app.models.words.language.lexicon import is_known, likeness
from app.models.words.language.wordnet import MIN_CONFIDENCE

MIN_LIKENESS = 0.5
"""Words of our lexicon with a smaller likeness are not used."""
MAX_BELOW_BEST = 0.05
"""Words with a likeness at most this much below the best one are used too."""
MAX_WORDS = 5
"""The largest number of words that replace a word."""


@dataclass(frozen=True, slots=True)
class Neighbor:
    """A word of the library and its likeness in meaning, 0..1."""

    word: str
    likeness: float


def neighbors(
    word: str, library: Iterable[str], related: Mapping[str, Mapping[str, float]]
) -> tuple[Neighbor, ...]:
    """The words of the library that are nearest to a normalized `word`, the best first.

    library: its words; related: WordNet's likeness by foreign word (see `wordnet`). Of two words
    that our lexicon has, it knows the likeness, and WordNet is not asked. The result is empty if
    no word is near.
    """
    own_words = tuple(library)
    for form in (word, *base_forms(word)):
        foreign = related.get(form, {})
        likenesses = {one: _likeness(form, one, foreign) for one in own_words}
        best = max(likenesses.values(), default=0.0)
        if best > 0.0:
            limit = best - MAX_BELOW_BEST
            near = [Neighbor(one, near) for one, near in likenesses.items() if near >= limit]
            return tuple(sorted(near, key=lambda n: (-n.likeness, n.word))[:MAX_WORDS])
        if is_known(form):  # its meaning is known, and no word of the library is near
            break
    return ()


def _likeness(word: str, own: str, foreign: Mapping[str, float]) -> float:
    """The likeness of `word` to a word of the library; 0 below the smallest that is used."""
    if is_known(word) and is_known(own):
        near, least = likeness(word, own), MIN_LIKENESS
    else:
        near, least = foreign.get(own, 0.0), MIN_CONFIDENCE
    return near if near >= least else 0.0
