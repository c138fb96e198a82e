"""Words as label vectors (Takano, section 2.2).

A word is normalized (lower case, phrases joined by underscores) and reduced to its base form
(jumping, jumps: jump). A vocabulary is the sorted list of the base forms in a library. The label
set of a clip is a binary vector over it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from app.models.words.language.inflection import base_form, base_forms
from app.models.words.language.lexicon import is_known
from app.models.words.language.normalize import normalize_words
from app.numerics.arrays import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class WordVocabulary:
    """The V words of a library: sorted, normalized base forms."""

    words: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.words)

    @classmethod
    def of(cls, label_sets: Iterable[Iterable[str]]) -> WordVocabulary:
        """All words of the label sets, each in its base form if that is a word too."""
        all_labels = {word for labels in label_sets for word in normalize_words(labels)}

        def is_word(word: str) -> bool:
            return word in all_labels or is_known(word)

        return cls(tuple(sorted({_label(word, is_word) for word in all_labels})))

    def find(self, word: str) -> str | None:
        """The vocabulary's word for a normalized word, inflected or not; None if there is none.

        *jumps* finds *jump*, and *jump* finds *jumping* if the library has only that.
        """
        base = base_form(word, self._column_of().__contains__)
        if base is not None:
            return base
        return next((own for own in self.words if word in base_forms(own)), None)

    def label_matrix(self, label_sets: Sequence[Iterable[str]]) -> FloatArray:
        """(N, V) float64 of ones and zeros; words outside the vocabulary are ignored."""
        columns = self._column_of()
        matrix = np.zeros((len(label_sets), len(self.words)))
        words: dict[str, str | None] = {}  # many clips share their labels
        for row, labels in enumerate(label_sets):
            for word in normalize_words(labels):
                if word not in words:
                    words[word] = self.find(word)
                if (own := words[word]) is not None:
                    matrix[row, columns[own]] = 1.0
        return matrix

    def vector(self, weights: Mapping[str, float]) -> FloatArray:
        """(V,) `weights` by word of the vocabulary, 0 elsewhere."""
        columns = self._column_of()
        vector = np.zeros(len(self.words))
        for word, weight in weights.items():
            vector[columns[word]] = weight
        return vector

    def columns(self, words: Iterable[str]) -> IntArray:
        """(c,) column indices of these words of the vocabulary."""
        return np.array([self.words.index(word) for word in words], dtype=np.int64)

    def _column_of(self) -> dict[str, int]:
        return {word: column for column, word in enumerate(self.words)}


def _label(word: str, is_word: Callable[[str], bool]) -> str:
    """The base form of a label; the label itself if it has no base form that is a word."""
    if is_known(word):
        return word
    return next(filter(is_word, base_forms(word)), word)
