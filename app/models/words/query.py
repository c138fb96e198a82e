"""What a query of words means to a library: weights of its words, and words to leave out.

Words are read as people write them (models.language): inflected, as a sentence, by other
words of the same meaning; `expanded` and `unknown` tell what became of each.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from app.models.words.language.meaning import neighbors
from app.models.words.language.sentence import read_query
from app.models.words.vocabulary import WordVocabulary


@dataclass(frozen=True, slots=True)
class WordsAsked:
    """weights: 0..1 by word of the vocabulary, 1 for what was asked for itself; meant: of each
    thing asked for, weights by the words that may stand for it; excluded: words
    of the vocabulary; unknown: what means nothing to the library; expanded: the vocabulary's
    words that stand for a word which is not one of them.
    """

    weights: Mapping[str, float]
    meant: tuple[Mapping[str, float], ...]
    excluded: tuple[str, ...]
    unknown: tuple[str, ...]
    expanded: Mapping[str, tuple[str, ...]]


def understand(
    texts: Iterable[str],
    vocabulary: WordVocabulary,
    related: Mapping[str, Mapping[str, float]],
) -> WordsAsked:
    """What `texts` (words, phrases, sentences) ask of a library with this vocabulary.

    related: neighbors in meaning that WordNet knows (models.language.wordnet), may be empty.
    """
    asked = read_query(texts, lambda word: vocabulary.find(word) is not None)
    weights: dict[str, float] = {}
    every: list[Mapping[str, float]] = []
    unknown: list[str] = []
    expanded: dict[str, tuple[str, ...]] = {}
    for word in asked.wanted:
        meant = _meant(word, vocabulary, related)
        if not meant:
            unknown.append(word)
        elif tuple(meant) != (word,):
            expanded[word] = tuple(meant)
        if meant and meant not in every:
            every.append(meant)
        for ours, weight in meant.items():
            weights[ours] = max(weights.get(ours, 0.0), weight)
    excluded = {word: vocabulary.find(word) for word in asked.excluded}
    unknown += [word for word, ours in excluded.items() if ours is None]
    known = tuple(dict.fromkeys(ours for ours in excluded.values() if ours is not None))
    unheard = tuple(dict.fromkeys(unknown))
    return WordsAsked(weights, tuple(every), known, unheard, expanded)


def _meant(
    word: str, vocabulary: WordVocabulary, related: Mapping[str, Mapping[str, float]]
) -> dict[str, float]:
    """The vocabulary's words for `word`, by weight; none where it means nothing here."""
    found = vocabulary.find(word)
    if found is not None:
        return {found: 1.0}
    return {near.word: near.likeness for near in neighbors(word, vocabulary.words, related)}
