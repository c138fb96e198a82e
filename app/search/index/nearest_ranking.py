"""Clips in order of the distance of their vectors to a query, computed page by page."""

from __future__ import annotations

from bisect import bisect_right
from functools import cached_property

import numpy as np

from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.numerics.nearest import distances_to, gather, nearest
from app.search.index.rows import RowsView
from app.search.ranking.cursor import Position
from app.search.ranking.ranking import IdArray, Page, Ranking

FIRST_COUNT = 256
"""Clips that are ranked first, if the number of needed clips is unknown."""


class NearestRanking:
    """A ranking (see `ranking.Ranked`) of the rows of an index with one row for each clip.

    Each page needs one pass over the vectors; the last page takes as long as the first.
    """

    anchor = None

    def __init__(self, version: int, rows: RowsView, mask: BoolArray, query: FloatArray) -> None:
        """version: of the library. mask: (n,) the clips that pass the filter. query: (width,)."""
        self.version = version
        self._rows = rows
        self._mask = mask
        self._query = query
        self._masks = rows.masks(mask)

    def __len__(self) -> int:
        return int(np.count_nonzero(self._mask))

    @property
    def ids(self) -> IdArray:
        """(n,) all clip ids in order."""
        return self._whole.ids

    @property
    def distances(self) -> FloatArray:
        """(n,) float64, never falling."""
        return self._whole.distances

    def page(self, after: Position | None, limit: int) -> Page:
        """The first `limit` clips after a position."""
        min_distance = None if after is None else after.distance
        # one clip more than the page, so that the page knows whether others follow
        rows, distances = nearest(
            self._rows.blocks, self._masks, self._query, limit + 1, min_distance
        )
        if after is None:
            order = np.argsort(distances)
            ordered = distances[order[: limit + 1]]
            if np.all(ordered[1:] > ordered[:-1]):  # else ids decide, and they are slow to read
                first = rows[order[:limit]]
                return Page(self._rows.labels.ids[first], ordered[:limit], len(rows) > limit)
        return self._ranking(rows, distances).page(after, limit)

    def until(self, distance: float, clip_id: str) -> Page:
        """All clips up to (distance, clip id), inclusive."""
        limit, key = FIRST_COUNT, (distance, clip_id)
        while True:
            page = self.page(None, limit)
            keys = list(zip(page.distances.tolist(), page.ids, strict=True))
            stop = bisect_right(keys, key)
            if stop < len(keys) or not page.more:
                return Page(page.ids[:stop], page.distances[:stop], stop < len(keys))
            limit *= 4

    def vectors(self, ids: IdArray) -> FloatArray:
        """(m, width) float32 vectors of the clips `ids` (m,) of a page."""
        return gather(self._rows.blocks, self._rows.labels.numbers(ids))

    def among(self, ids: IdArray) -> BoolArray:
        """(m,) whether each of the clips `ids` (m,) is ranked."""
        ranked = np.append(self._mask, False)  # the last one is for clips without a number
        return np.asarray(ranked[self._rows.labels.find(ids)])

    def distances_of(self, ids: IdArray) -> FloatArray:
        """(m,) float64 distances of the clips `ids` (m,); infinity for those not ranked."""
        known, far = self.among(ids), np.full(len(ids), np.inf)
        if not known.any():  # the index may have no vectors at all
            return far
        away = self.vectors(ids[known]).astype(np.float64) - self._query
        far[known] = np.sqrt(np.vecdot(away, away))
        return far

    def without(self, ids: IdArray) -> NearestRanking:
        """The ranking without the clips `ids` (m,), which are in the index."""
        mask = self._mask.copy()
        mask[self._rows.labels.numbers(ids)] = False
        return NearestRanking(self.version, self._rows, mask, self._query)

    @cached_property
    def _whole(self) -> Ranking:
        rows = np.flatnonzero(self._mask)
        return self._ranking(rows, distances_to(self._rows.blocks, rows, self._query))

    def _ranking(self, rows: IntArray, distances: FloatArray) -> Ranking:
        return Ranking(self._rows.labels.ids[rows], distances)
