"""A ranking of clips whose distances cost much, while lower bounds of them cost little.

Clips are measured in the order of their bounds, until no other clip can be nearer than those found.
So a page is the same as if every clip had been measured.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from app.deadline import check
from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.numerics.nearest import DECIMALS
from app.search.ranking.cursor import Position
from app.search.ranking.ranking import IdArray, Page, Ranking

MIN_MEASURED = 16
"""Clips that are measured at a time, at least: one clip alone costs nearly as much."""

Measure = Callable[[IntArray], FloatArray]
"""Distances (m,) of the clips with these numbers (m,), ascending; infinity for one that is gone.

A distance must depend on its clip alone, not on the other clips that are measured with it."""


@dataclass(frozen=True, slots=True)
class LowerBounds:
    """Clips (n,), lower bounds of their distances (n,), and the function that measures them."""

    ids: IdArray
    least: FloatArray
    measure: Measure


class LowerBoundRanking:
    """Clips in order of distance, measured as pages need them; clips that are gone are left out."""

    def __init__(self, clips: LowerBounds, most: float = np.inf) -> None:
        """most: larger distances count as this."""
        self._ids = clips.ids
        self._measure = clips.measure
        self._most = most
        self._least = self._rounded(clips.least)
        self._distances = np.full(len(clips.ids), np.inf)
        self._waiting = np.ones(len(clips.ids), dtype=bool)

    @property
    def measured(self) -> int:
        """Clips that were measured so far."""
        return int(len(self._ids) - np.count_nonzero(self._waiting))

    @property
    def end(self) -> float | None:
        """The largest distance, 0 where there is none; None until all are measured."""
        if self._waiting.any():
            return None
        return float(np.max(self._distances, initial=0.0, where=self._is_there()))

    def page(self, after: Position | None, limit: int) -> Page:
        """The first `limit` clips behind a position."""
        self._look(self._least <= (-1.0 if after is None else after.distance))
        while True:
            check()
            page = self._so_far().page(after, limit + 1)
            if len(page.ids) <= limit:
                missing = limit + 1 - len(page.ids)
                some = self._nearest_bounds(max(missing, MIN_MEASURED))
            else:
                some = self._least <= page.distances[-1]
            if not self._look(some):
                break
        return Page(page.ids[:limit], page.distances[:limit], len(page.ids) > limit)

    def _so_far(self) -> Ranking:
        there = self._is_there()
        return Ranking(self._ids[there], self._distances[there])

    def _is_there(self) -> BoolArray:
        return np.asarray(np.isfinite(self._distances))

    def _nearest_bounds(self, count: int) -> BoolArray:
        """(n,) the `count` clips with the smallest bounds of those that are not measured yet."""
        numbers = np.flatnonzero(self._waiting)
        chosen = np.zeros(len(self._waiting), dtype=bool)
        chosen[numbers[np.argsort(self._least[numbers], kind="stable")[:count]]] = True
        return chosen

    def _look(self, chosen: BoolArray) -> bool:
        """Measure those of `chosen` (n,) that are not measured yet; return whether any was."""
        numbers = np.flatnonzero(chosen & self._waiting)
        if len(numbers):
            found = self._measure(numbers)
            self._distances[numbers] = np.where(np.isfinite(found), self._rounded(found), np.inf)
            self._waiting[numbers] = False
        return bool(len(numbers))

    def _rounded(self, distances: FloatArray) -> FloatArray:
        return np.asarray(np.round(np.minimum(distances, self._most), DECIMALS))
