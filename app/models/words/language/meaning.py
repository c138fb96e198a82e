"""Finds words of the library that are similar in meaning to a word that no clip carries."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from app.models.words.language.inflection import base_forms
from app.models.words.language.lexicon import is_known, likeness

MIN_LIKENESS = 0.5
WITHIN = 0.05
"""Words whose likeness is at most this much below the best are used too."""
MAX_WORDS = 5


@dataclass(frozen=True, slots=True)
class Neighbor:
    """A word of the library and its likeness in meaning, 0..1."""

    word: str
    likeness: float


def neighbors(
    word: str, library: Iterable[str], related: Mapping[str, Mapping[str, float]]
) -> tuple[Neighbor, ...]:
    """The words of the library that are nearest to a normalized `word`, the best first.

    library: its words; related: WordNet's likeness by foreign word (see `wordnet`). Our lexicon
    has priority. The result is empty if no word is near.
    """
    ours = tuple(library)
    for form in (word, *base_forms(word)):
        found = {one: likeness(form, one) for one in ours} if is_known(form) else {}
        if max(found.values(), default=0.0) < MIN_LIKENESS:
            found = {one: near for one, near in related.get(form, {}).items() if one in ours}
        best = max(found.values(), default=0.0)
        if best >= MIN_LIKENESS:
            near = [Neighbor(one, near) for one, near in found.items() if near >= best - WITHIN]
            return tuple(sorted(near, key=lambda n: (-n.likeness, n.word))[:MAX_WORDS])
    return ()
