"""A ranking of clips with slow distances, which have lower bounds that are fast to compute.

Clips are measured in the order of their bounds, until no other clip can be nearer than the clips of
the page. So a page is the same as if all clips were measured.
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
"""Smallest number of clips that are measured at a time: one clip alone takes nearly as long."""

Measure = Callable[[IntArray], FloatArray]
"""A function from ascending numbers (m,) of clips to distances (m,), infinity for a deleted clip.

A distance must depend only on its own clip, not on the other clips that are measured with it."""


@dataclass(frozen=True, slots=True)
class LowerBounds:
    """Clips (n,), lower bounds of their distances (n,), and the function that measures them."""

    ids: IdArray
    bounds: FloatArray
    measure: Measure


class LowerBoundRanking:
    """Clips in order of distance, measured when a page needs them; deleted clips are left out."""

    def __init__(self, clips: LowerBounds, max_distance: float = np.inf) -> None:
        """max_distance: larger distances are set to this."""
        self._ids = clips.ids
        self._measure = clips.measure
        self._max_distance = max_distance
        self._bounds = self._rounded(clips.bounds)
        self._distances = np.full(len(clips.ids), np.inf)
        self._waiting = np.ones(len(clips.ids), dtype=bool)

    @property
    def measured(self) -> int:
        """The number of clips that were measured so far."""
        return int(len(self._ids) - np.count_nonzero(self._waiting))

    @property
    def end(self) -> float | None:
        """The largest distance, 0 without clips; None until all clips are measured."""
        if self._waiting.any():
            return None
        return float(np.max(self._distances, initial=0.0, where=self._is_stored()))

    def page(self, after: Position | None, limit: int) -> Page:
        """The first `limit` clips after a position."""
        self._measure_some(self._bounds <= (-1.0 if after is None else after.distance))
        while True:
            check()
            page = self._measured_clips().page(after, limit + 1)
            if len(page.ids) <= limit:
                # The page is not full. One clip more shows whether others follow.
                missing = limit + 1 - len(page.ids)
                some = self._nearest_bounds(max(missing, MIN_MEASURED))
            else:
                # The page is full: measure all clips that could still be on it.
                some = self._bounds <= page.distances[-1]
            if not self._measure_some(some):
                break
        return Page(page.ids[:limit], page.distances[:limit], len(page.ids) > limit)

    def _measured_clips(self) -> Ranking:
        """The ranking of the clips that were measured so far."""
        is_stored = self._is_stored()
        return Ranking(self._ids[is_stored], self._distances[is_stored])

    def _is_stored(self) -> BoolArray:
        """(n,) whether each clip was measured and was not deleted."""
        return np.asarray(np.isfinite(self._distances))

    def _nearest_bounds(self, count: int) -> BoolArray:
        """(n,) the `count` clips with the smallest bounds that are not measured yet."""
        numbers = np.flatnonzero(self._waiting)
        chosen = np.zeros(len(self._waiting), dtype=bool)
        chosen[numbers[np.argsort(self._bounds[numbers], kind="stable")[:count]]] = True
        return chosen

    def _measure_some(self, chosen: BoolArray) -> bool:
        """Measure the clips in `chosen` (n,) that are not measured yet; return whether any was."""
        numbers = np.flatnonzero(chosen & self._waiting)
        if len(numbers):
            measured = self._measure(numbers)
            is_stored = np.isfinite(measured)
            self._distances[numbers] = np.where(is_stored, self._rounded(measured), np.inf)
            self._waiting[numbers] = False
        return bool(len(numbers))

    def _rounded(self, distances: FloatArray) -> FloatArray:
        return np.asarray(np.round(np.minimum(distances, self._max_distance), DECIMALS))
