"""The meaning of a query of words in a library: weights of its words, and words to exclude.

Words may be inflected, in a sentence, or replaced by other words of the same meaning
(app.models.words.language); `expanded` and `unknown` report what each word became.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from app.models.words.language.meaning import neighbors
from app.models.words.language.sentence import read_query
from app.models.words.vocabulary import WordVocabulary


@dataclass(frozen=True, slots=True)
class WordQuery:
    """A query that a library understands.

    weights: 0..1 by word of the vocabulary, 1 for a word of the query itself; meant: for each
    item of the query, weights by the words that can replace it; excluded: words of the
    vocabulary; unknown: words without a meaning in the library; expanded: for each word outside
    the vocabulary, the words that replace it.
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
) -> WordQuery:
    """The meaning of `texts` (words, phrases, sentences) for this vocabulary.

    related: related words from WordNet (app.models.words.language.wordnet); may be empty.
    """
    asked = read_query(texts, lambda word: vocabulary.find(word) is not None)
    weights: dict[str, float] = {}
    every: list[Mapping[str, float]] = []
    unknown: list[str] = []
    expanded: dict[str, tuple[str, ...]] = {}
    for word in asked.included:
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
    return WordQuery(weights, tuple(every), known, unheard, expanded)


def _meant(
    word: str, vocabulary: WordVocabulary, related: Mapping[str, Mapping[str, float]]
) -> dict[str, float]:
    """Weights of the vocabulary's words for `word`; empty if it has no meaning here."""
    found = vocabulary.find(word)
    if found is not None:
        return {found: 1.0}
    return {near.word: near.likeness for near in neighbors(word, vocabulary.words, related)}
