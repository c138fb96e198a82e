"""The meaning of a query of words in a library: weights of its words, and words to exclude.

Words may be inflected, in a sentence, or replaced: by other words of the same meaning
(app.models.words.language), or by a detector of a movement or of a part of the body
(app.models.words.detectors). `expanded`, `confidence` and `unknown` report the replacement of each
word.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from app.models.words.detectors import (
    CONFIDENCE,
    body_detector,
    body_part,
    body_side,
    movement_detector,
)
from app.models.words.language.meaning import neighbors
from app.models.words.language.sentence import QueryWords, read_query
from app.models.words.vocabulary import WordVocabulary


@dataclass(frozen=True, slots=True)
class WordQuery:
    """A query in the words of a library.

    weights: 0..1 by word of the vocabulary, 1 for a word of the query itself; items: for each
    word of the query, the weights of the words or detectors that can replace it; excluded: words
    of the vocabulary; unknown: words without a meaning in the library; expanded: for each word
    outside the vocabulary, what replaces it; confidence: for each of these, 0..1, how sure it is
    that the replacement means the same.
    """

    weights: Mapping[str, float]
    items: tuple[Mapping[str, float], ...]
    excluded: tuple[str, ...]
    unknown: tuple[str, ...]
    expanded: Mapping[str, tuple[str, ...]]
    confidence: Mapping[str, float] = field(default_factory=dict)


def understand(
    texts: Iterable[str],
    vocabulary: WordVocabulary,
    related: Mapping[str, Mapping[str, float]],
) -> WordQuery:
    """The meaning of `texts` (words, phrases, sentences) for this vocabulary.

    related: related words from WordNet (app.models.words.language.wordnet); may be empty.
    """
    asked = read_query(texts, lambda word: vocabulary.find(word) is not None)
    replacements = _replacements(asked, vocabulary, related)
    items = [item for _, item in replacements if item]
    excluded = {word: vocabulary.find(word) for word in asked.excluded}
    unknown = [word for word, item in replacements if not item]
    unknown += [word for word, label in excluded.items() if label is None]
    expanded = {word: tuple(item) for word, item in replacements if item and tuple(item) != (word,)}
    own = set(vocabulary.words)
    weights: dict[str, float] = {}
    for item in items:
        for word in own.intersection(item):
            weights[word] = max(weights.get(word, 0.0), item[word])
    return WordQuery(
        weights=weights,
        items=tuple(item for row, item in enumerate(items) if item not in items[:row]),
        excluded=tuple(dict.fromkeys(label for label in excluded.values() if label is not None)),
        unknown=tuple(dict.fromkeys(unknown)),
        expanded=expanded,
        confidence={word: max(item.values()) for word, item in replacements if word in expanded},
    )


def _replacements(
    asked: QueryWords, vocabulary: WordVocabulary, related: Mapping[str, Mapping[str, float]]
) -> list[tuple[str, dict[str, float]]]:
    """Each word of a query, with the weights of what it means here; empty without a meaning."""
    found: list[tuple[str, dict[str, float]]] = []
    for before, word, following in _with_neighbors(asked.included):
        own = vocabulary.find(word)
        if own is not None:
            found.append((word, {own: 1.0}))
        elif (side := body_side(word)) is not None:
            part = body_part(following)
            if part is None or vocabulary.find(following) is not None:
                found.append((word, {body_detector(part, side): CONFIDENCE}))
            # else the part says both: left ankle
        elif (part := body_part(word)) is not None:
            side = body_side(before)
            near = {} if side else _neighbors(word, vocabulary, related)
            phrase = f"{before} {word}" if side and vocabulary.find(before) is None else word
            found.append((phrase, near or {body_detector(part, side): CONFIDENCE}))
        elif word in asked.things:
            found.append((word, {}))
        else:
            found.append((word, _neighbors(word, vocabulary, related) or _measured(word)))
    return found


def _with_neighbors(words: Sequence[str]) -> Iterator[tuple[str, str, str]]:
    """Each word, with the word before it and the word after it; "" at the ends."""
    return zip(("", *words), words, (*words[1:], ""), strict=False)


def _neighbors(
    word: str, vocabulary: WordVocabulary, related: Mapping[str, Mapping[str, float]]
) -> dict[str, float]:
    """Weights of the vocabulary's words that are near to `word`."""
    return {near.word: near.likeness for near in neighbors(word, vocabulary.words, related)}


def _measured(word: str) -> dict[str, float]:
    """The detector of the movement that `word` names."""
    found = movement_detector(word)
    return {} if found is None else {found.name: round(CONFIDENCE * found.likeness, 3)}
