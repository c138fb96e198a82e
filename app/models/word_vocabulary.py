"""Words as label vectors (Takano, section 2.2).

A word is normalised (lower case, phrases joined by underscores); a vocabulary is the
sorted list of those that a library carries; a clip's label set is a binary vector over it.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from app.numerics.arrays import FloatArray

_JOINERS = re.compile(r"[\s\-_]+")


def normalise_word(word: str) -> str:
    """`word` in lower case, hyphens and blanks as single underscores: "High-Kick" -> "high_kick".

    Empty where nothing is left.
    """
    return _JOINERS.sub("_", word.strip().casefold()).strip("_")


def normalise_words(words: Iterable[str]) -> tuple[str, ...]:
    """Normalised words in their order, each once, empty ones left out."""
    return tuple(dict.fromkeys(filter(None, map(normalise_word, words))))


@dataclass(frozen=True, slots=True)
class WordQuery:
    """A query over a vocabulary: label vector (V,) of ones and zeros, and the known and
    unknown words in it, normalised.
    """

    vector: FloatArray
    known: tuple[str, ...]
    unknown: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class WordVocabulary:
    """The words of a library, sorted, normalised; V of them."""

    words: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.words)

    @classmethod
    def of(cls, label_sets: Iterable[Iterable[str]]) -> WordVocabulary:
        """All words of the label sets."""
        found = {word for labels in label_sets for word in normalise_words(labels)}
        return cls(tuple(sorted(found)))

    def label_matrix(self, label_sets: Sequence[Iterable[str]]) -> FloatArray:
        """(N, V) float64 of ones and zeros; words outside the vocabulary are ignored."""
        columns = {word: column for column, word in enumerate(self.words)}
        matrix = np.zeros((len(label_sets), len(self.words)))
        for row, labels in enumerate(label_sets):
            for word in normalise_words(labels):
                if word in columns:
                    matrix[row, columns[word]] = 1.0
        return matrix

    def query(self, words: Iterable[str]) -> WordQuery:
        """The label vector of a query; words that no clip carries are told as unknown."""
        wanted = normalise_words(words)
        known = tuple(word for word in wanted if word in self.words)
        unknown = tuple(word for word in wanted if word not in self.words)
        return WordQuery(self.label_matrix([known])[0], known, unknown)
