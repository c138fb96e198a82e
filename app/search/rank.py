"""Rankings: clips in order of distance, with scores that fall strictly with it.

Distances are rounded to nine decimals before they are ordered, so that two that differ
also differ in their score, whatever the rounding of 1 / (1 + d).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.numerics.arrays import FloatArray
from app.search.cursor import Position

IdArray = NDArray[np.object_]

DECIMALS = 9
"""Distances closer than this are equal, and ordered by clip id."""


@dataclass(frozen=True, slots=True)
class Ranking:
    """Clips from the nearest to the farthest, ties by id.

    ids: (n,) clip ids; distances: (n,) float64, never falling.
    """

    ids: IdArray
    distances: FloatArray

    def __len__(self) -> int:
        return len(self.ids)

    def after(self, position: Position | None) -> int:
        """Index of the first clip behind a position; 0 where there is none."""
        if position is None:
            return 0
        start = int(np.searchsorted(self.distances, position.distance, side="left"))
        while start < len(self) and self._key(start) <= (position.distance, position.clip_id):
            start += 1
        return start

    def _key(self, index: int) -> tuple[float, Any]:
        return float(self.distances[index]), self.ids[index]


def ranking(ids: IdArray, distances: FloatArray) -> Ranking:
    """Order clips (n,) by distances (n,), then by id."""
    rounded = np.round(np.asarray(distances, dtype=np.float64), DECIMALS)
    order = np.argsort(rounded, kind="stable")
    if np.any(np.diff(rounded[order]) == 0):
        # Sorting by id as well costs ten times as much; only ties need it.
        order = np.lexsort((ids.astype(str), rounded))
    return Ranking(ids[order], rounded[order])


def score(distance: float, scale: float = 1.0) -> float:
    """1 at distance 0, one half at distance `scale`, towards 0 beyond; strictly falling."""
    return scale / (scale + distance)


def behind(head: FloatArray, shortlisted: FloatArray, rest: FloatArray) -> FloatArray:
    """Distances for the clips that a re-rank left out, all behind those that it ranked.

    head: (s,) final distances of the shortlist; shortlisted: (s,) and rest: (r,) their
    first-stage distances. The rest keeps its own order and spacing, shifted to start
    where the head ends. Returns (r,).
    """
    if not len(head) or not len(rest):
        return np.asarray(rest, dtype=np.float64)
    beyond = np.maximum(np.asarray(rest, dtype=np.float64) - np.max(shortlisted), 0.0)
    return np.max(head) + beyond
