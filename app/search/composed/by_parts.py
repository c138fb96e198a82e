"""Ranks clips by a query of several parts: examples and words, for something or against it.

A fast stage gives every clip the probability of each part, by motion vectors, by coordinates of a
learned metric, or by words. If the method is slower, the first 300 clips of this ranking, the
shortlist, are ranked again by its exact distances to every example. The other clips follow in the
order of the fast stage. So the order within the shortlist is exact; a clip that is far by vectors
is not found by warping.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.search.composed.surprise import Part, costs, mean_surprise
from app.search.example.fusion import SHORTLIST
from app.search.example.reranking import ShortlistRanking
from app.search.ranking.cursor import Anchor, Position
from app.search.ranking.lower_bounds import LowerBounds
from app.search.ranking.ranking import IdArray, Page, Ranked, Ranking


@dataclass(frozen=True, slots=True)
class SecondStage:
    """The exact distances of an example to the clips (m,) of a shortlist.

    measured: from clip ids (m,) to their distances; likely: from distances to probabilities, which
    fall with the distance.
    """

    measured: Callable[[IdArray], LowerBounds]
    likely: Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, slots=True)
class Evidence:
    """A part of a query, and (n,) the probability that it is true of each clip.

    second: the part's second stage; None if the probabilities are final.
    """

    part: Part
    probabilities: FloatArray
    second: SecondStage | None = None


class PartsRanking:
    """Clips by the mean surprise of all parts, the best first."""

    def __init__(
        self, ids: IdArray, evidence: Sequence[Evidence], anchor: Anchor | None = None
    ) -> None:
        """ids: (n,) of the clips, each once; evidence: at least one; anchor: of the cursor."""
        self._ids = ids
        self._evidence = evidence
        self._parts = [one.part for one in evidence]
        self._measured: dict[str, tuple[float, ...]] = {}
        first = Ranking(ids, mean_surprise(self._parts, [one.probabilities for one in evidence]))
        has_second = any(one.second for one in evidence)
        self._ranking: Ranked = (
            ShortlistRanking(first, self._rerank, SHORTLIST, anchor) if has_second else first
        )

    def page(self, after: Position | None, limit: int) -> Page:
        """The first `limit` clips after a position."""
        return self._ranking.page(after, limit)

    @property
    def anchor(self) -> Anchor | None:
        """The anchor of the next page's cursor, see `Anchor`."""
        return self._ranking.anchor

    def probabilities(self, clip_id: str) -> tuple[float, ...]:
        """The probability of each part for a clip of a page, as the ranking used it."""
        row = self._rows[clip_id]
        fast = tuple(float(one.probabilities[row]) for one in self._evidence)
        return self._measured.get(clip_id, fast)

    def costs(self, clip_id: str) -> list[float]:
        """What each part adds to the distance of a clip of a page."""
        return costs(self._parts, self.probabilities(clip_id))

    @cached_property
    def _rows(self) -> dict[str, int]:
        return {clip_id: row for row, clip_id in enumerate(self._ids)}

    def _rerank(self, ids: IdArray) -> LowerBounds:
        """The distances of the clips (m,) of the shortlist by the second stages."""
        rows = np.array([self._rows[clip_id] for clip_id in ids], dtype=np.int64)
        stages = [_Shortlisted.of(one, ids, rows) for one in self._evidence]

        def measure(chosen: IntArray) -> FloatArray:
            found = [stage.measure(chosen) for stage in stages]
            is_stored = np.logical_and.reduce([stored for _, stored in found])
            likely = [probabilities for probabilities, _ in found]
            for place, clip_id in enumerate(ids[chosen]):
                self._measured[clip_id] = tuple(float(one[place]) for one in likely)
            return np.where(is_stored, mean_surprise(self._parts, likely), np.inf)

        best = [stage.best for stage in stages]
        return LowerBounds(ids, mean_surprise(self._parts, best), measure)


@dataclass(frozen=True, slots=True)
class _Shortlisted:
    """A part for the clips (m,) of a shortlist.

    best: (m,) the probabilities of the least surprise that is possible; measure: from ascending
    numbers (k,) of clips to their probabilities, and to whether each is still stored.
    """

    best: FloatArray
    measure: Callable[[IntArray], tuple[FloatArray, BoolArray]]

    @classmethod
    def of(cls, evidence: Evidence, ids: IdArray, rows: IntArray) -> _Shortlisted:
        """The part for clips `ids` (m,), which are at `rows` (m,) of the evidence."""
        second, known = evidence.second, evidence.probabilities[rows]
        if second is None:
            return cls(known, lambda chosen: (known[chosen], np.ones(len(chosen), dtype=bool)))
        clips = second.measured(ids)

        def measure(chosen: IntArray) -> tuple[FloatArray, BoolArray]:
            distances = clips.measure(chosen)
            return second.likely(distances), np.isfinite(distances)

        is_against = evidence.part.is_against
        # A clip may turn out to be as far from what is not wanted as it likes.
        best = np.zeros(len(ids)) if is_against else second.likely(clips.bounds)
        return cls(best, measure)
