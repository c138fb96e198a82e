"""The words of a query of several parts: the clips they leave out, and how likely they are true."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.models.words.query import WordQuery
from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.search.composed.surprise import surprise
from app.search.index.labels import LabelView
from app.search.ranking.ranking import IdArray
from app.services.find.by_words import Words, measure, probabilities, probably_carries
from app.services.find.hits import PartScore
from app.services.library.library import Library


@dataclass(frozen=True, slots=True)
class WordParts:
    """Words as the fitted model understands them.

    texts: as they were asked for; asked: the meaning of all of them together; clips: of the index.
    """

    lib: Library
    fitted: Words
    texts: Sequence[str]
    asked: WordQuery
    mode: str
    clips: LabelView

    @classmethod
    def of(cls, lib: Library, clips: LabelView, texts: Sequence[str], mode: str) -> WordParts:
        """The words `texts`. Raises ModelNotFitted."""
        fitted = lib.models.words(lib.store)
        return cls(lib, fitted, texts, fitted.model.ask(texts), mode, clips)

    def kept(self, mask: BoolArray) -> BoolArray:
        """(n,) the clips in `mask` (n,) without those that carry a word with a minus."""
        excluded = self.asked.excluded
        if not excluded:
            return mask
        return mask & ~probably_carries(self.lib, self.fitted, self.clips, excluded)

    def likely(self, mask: BoolArray) -> tuple[IntArray, FloatArray]:
        """Rows (k,) of the clips in `mask` (n,) that the model knows, and (k,) probabilities.

        They are the probabilities that a clip carries all words without a minus; there must be one
        that the library knows. Raises NotEnoughLabels without a correlated space in mode "cca".
        """
        rows, distances = measure(self.lib, self.fitted, self.clips, mask, self.asked, self.mode)
        return rows, probabilities(self.fitted.model, self.asked, self.mode, distances)

    def scores(self, ids: IdArray, costs: Sequence[float]) -> list[tuple[PartScore, ...]]:
        """For each of the clips `ids` (m,), how likely it carries each text.

        costs: (m,) what all words together add to a clip's distance. It is divided among the texts
        in proportion to the surprise of each. A text without a meaning has no score.
        """
        numbers = self.clips.numbers(ids)
        columns = [
            (f"words.{place}", self._of_text(text, numbers))
            for place, text in enumerate(self.texts)
        ]
        return [
            self._shared(
                [
                    PartScore(part, is_against, score, 0.0)
                    for part, found in columns
                    for is_against, values in found
                    if (score := values.get(int(number))) is not None
                ],
                cost,
            )
            for number, cost in zip(numbers, costs, strict=True)
        ]

    def _shared(self, texts: list[PartScore], cost: float) -> tuple[PartScore, ...]:
        """The scores of texts, with their shares of the cost of all words together."""
        surprises = [
            surprise(np.array([one.score]), is_against=one.is_against).item() for one in texts
        ]
        if self.asked.items:  # then a text with a minus only leaves clips out
            surprises = [
                0.0 if one.is_against else own for one, own in zip(texts, surprises, strict=True)
            ]
        total = sum(surprises)
        return tuple(
            replace(one, cost=cost * own / total if total > 0.0 else 0.0)
            for one, own in zip(texts, surprises, strict=True)
        )

    def _of_text(self, text: str, numbers: IntArray) -> list[tuple[bool, dict[int, float]]]:
        """Whether a text is against something, and its probabilities by the clips' numbers.

        The list is empty for a text without a meaning. A text counts as against something if it
        has only words with a minus.
        """
        asked = self.fitted.model.ask([text])
        if not asked.items and not asked.excluded:
            return []
        mask = np.zeros(len(self.clips.ids), dtype=bool)
        mask[numbers] = True
        rows, distances = measure(self.lib, self.fitted, self.clips, mask, asked, self.mode)
        likely = probabilities(self.fitted.model, asked, self.mode, distances)
        is_against = not asked.weights
        if is_against:  # the probability that the clip carries none of the words, until here
            likely = 1.0 - likely
        return [(is_against, dict(zip(rows.tolist(), likely.tolist(), strict=True)))]
