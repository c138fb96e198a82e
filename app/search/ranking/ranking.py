"""Rankings: clips in order of distance, with scores that fall strictly with the distance.

Distances are rounded to nine decimals before they are ordered. So two distances that differ have
scores that differ, although 1 / (1 + d) is rounded too. Clips with equal distances are in the order
of their ids. A ranking is sorted only as far as it is read.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from app.numerics.arrays import FloatArray, IntArray
from app.numerics.nearest import DECIMALS as DECIMALS
from app.search.ranking.cursor import Anchor, Position

IdArray = NDArray[np.object_]


@dataclass(frozen=True, slots=True)
class Page:
    """Some clips of a ranking: ids (n,) and distances (n,) float64. more: whether others follow."""

    ids: IdArray
    distances: FloatArray
    more: bool


class Ranked(Protocol):
    """Clips from the nearest to the farthest; clips with equal distances are sorted by id."""

    @property
    def anchor(self) -> Anchor | None:
        """The part of a cursor that makes the next page continue the same ranking; see `Anchor`."""

    @property
    def ids(self) -> IdArray:
        """(n,) all clip ids in order."""

    @property
    def distances(self) -> FloatArray:
        """(n,) float64, never falling."""

    def __len__(self) -> int: ...

    def page(self, after: Position | None, limit: int) -> Page:
        """The first `limit` clips after a position; the clip at the position may be deleted."""


class FirstStage(Ranked, Protocol):
    """A ranking whose first clips, the shortlist, can be ranked again."""

    def until(self, distance: float, clip_id: str) -> Page:
        """All clips up to (distance, clip id), inclusive."""


class Ranking:
    """A ranking of clips with known distances."""

    anchor: Anchor | None = None

    def __init__(self, ids: IdArray, distances: FloatArray) -> None:
        """ids: (n,) objects; distances: (n,); in any order."""
        self._ids = ids
        self._distances = np.round(np.asarray(distances, dtype=np.float64), DECIMALS)

    def __len__(self) -> int:
        return len(self._ids)

    @property
    def ids(self) -> IdArray:
        """(n,) all clip ids in order."""
        return self._ids[self._order]

    @property
    def distances(self) -> FloatArray:
        """(n,) float64, never falling."""
        return self._distances[self._order]

    def page(self, after: Position | None, limit: int) -> Page:
        """The first `limit` clips after a position."""
        rows = np.arange(len(self)) if after is None else self._rows_after(after)
        distances = self._distances[rows]
        if len(rows) > limit:
            # only the clips of the page, and those as far as the next clip, are sorted
            near = distances <= np.partition(distances, limit)[limit]
            rows, distances = rows[near], distances[near]
        more = len(rows) > limit
        order = in_order(self._ids[rows], distances)[:limit]
        return Page(self._ids[rows[order]], distances[order], more)

    def until(self, distance: float, clip_id: str) -> Page:
        """All clips up to (distance, clip id), inclusive."""
        after = len(self._rows_after(Position(0, distance, clip_id)))
        return self.page(None, len(self) - after)

    @cached_property
    def _order(self) -> IntArray:
        return in_order(self._ids, self._distances)

    def _rows_after(self, after: Position) -> IntArray:
        """The indices of the clips that are farther, or equally far with a larger id."""
        is_after = self._distances > after.distance
        equal = np.flatnonzero(self._distances == after.distance)
        is_after[equal] = [clip_id > after.clip_id for clip_id in self._ids[equal]]
        return np.flatnonzero(is_after)


def in_order(ids: IdArray, distances: FloatArray) -> IntArray:
    """(n,) indices that sort clips by rounded distances (n,), then by id."""
    order = np.argsort(distances, kind="stable")
    if np.any(np.diff(distances[order]) == 0):
        # A sort by distance and id takes ten times as long. Only equal distances need it.
        order = np.lexsort((ids.astype(str), distances))
    return order


def score(distance: float, scale: float = 1.0) -> float:
    """The score of a distance: 1 at 0, 0.5 at `scale`; it falls strictly, toward 0."""
    return scale / (scale + distance)
