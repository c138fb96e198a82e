"""The meaning of a query of words in a library: weights of its words, and words to exclude.

Words may be inflected, in a sentence, or replaced by other words of the same meaning
(app.models.words.language). `expanded` and `unknown` report the replacement of each word.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from app.models.words.language.meaning import neighbors
from app.models.words.language.sentence import read_query
from app.models.words.vocabulary import WordVocabulary


@dataclass(frozen=True, slots=True)
class WordQuery:
    """A query in the words of a library.

    weights: 0..1 by word of the vocabulary, 1 for a word of the query itself; items: for each
    word of the query, the weights of the words that can replace it; excluded: words of the
    vocabulary; unknown: words without a meaning in the library; expanded: for each word outside
    the vocabulary, the words that replace it.
    """

    weights: Mapping[str, float]
    items: tuple[Mapping[str, float], ...]
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
    items: list[Mapping[str, float]] = []
    unknown: list[str] = []
    expanded: dict[str, tuple[str, ...]] = {}
    for word in asked.included:
        item = _replacements(word, vocabulary, related)
        if not item:
            unknown.append(word)
        elif tuple(item) != (word,):
            expanded[word] = tuple(item)
        if item and item not in items:
            items.append(item)
        for replacement, weight in item.items():
            weights[replacement] = max(weights.get(replacement, 0.0), weight)
    excluded = {word: vocabulary.find(word) for word in asked.excluded}
    unknown += [word for word, label in excluded.items() if label is None]
    labels = tuple(dict.fromkeys(label for label in excluded.values() if label is not None))
    return WordQuery(weights, tuple(items), labels, tuple(dict.fromkeys(unknown)), expanded)


def _replacements(
    word: str, vocabulary: WordVocabulary, related: Mapping[str, Mapping[str, float]]
) -> dict[str, float]:
    """Weights of the vocabulary's words for `word`; empty if it has no meaning here."""
    own = vocabulary.find(word)
    if own is not None:
        return {own: 1.0}
    return {near.word: near.likeness for near in neighbors(word, vocabulary.words, related)}
