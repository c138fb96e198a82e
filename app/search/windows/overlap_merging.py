"""Parts of clips in order of distance, where the nearest stands for those that overlap it.

Of two parts that share more than MAX_OVERLAP of the shorter one, only the nearer is kept (greedy
non-maximum suppression). Only as many are compared as a page needs.
"""

from __future__ import annotations

from bisect import bisect_left, insort
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from app.deadline import check
from app.numerics.arrays import FloatArray, IntArray
from app.search.ranking.cursor import Position
from app.search.ranking.ranking import DECIMALS, IdArray

MAX_OVERLAP = 0.2
"""Share of the shorter of two parts; parts that overlap by more are merged."""

FIRST_LOOK = 2048
"""Candidates that are sorted first; then four times as many, and so on."""


@dataclass(frozen=True, slots=True)
class Candidates:
    """Parts of clips and their distances, in any order.

    ids: (c,) clip ids by number; owners: (k,) those numbers; starts, ends: (k,) seconds;
    distances: (k,), finite.
    """

    ids: IdArray
    owners: IntArray
    starts: FloatArray
    ends: FloatArray
    distances: FloatArray

    def __len__(self) -> int:
        return len(self.owners)

    def at(self, distances: FloatArray) -> Candidates:
        """The same at other distances (k,)."""
        return replace(self, distances=distances)


@dataclass(frozen=True, slots=True)
class FoundInterval:
    """A part of a clip, in seconds, and its distance; index: of the candidate."""

    clip_id: str
    start: float
    end: float
    distance: float
    index: int

    @property
    def key(self) -> str:
        """Orders parts of the same distance, and identifies one in a cursor."""
        return f"{self.clip_id} {self.start:013.4f} {self.end:013.4f}"


def merge_overlapping(
    found: Candidates, count: int, after: Position | None = None, until: float = np.inf
) -> tuple[list[FoundInterval], bool]:
    """The `count` nearest parts behind a position, and whether more follow.

    until: parts that are farther are left out.
    """
    behind = (-1.0, "") if after is None else (after.distance, after.clip_id)
    nearest: list[FoundInterval] = []
    for part in _merged(found):
        if part.distance > until:
            break
        if (part.distance, part.key) > behind:
            if len(nearest) == count:
                return nearest, True
            nearest.append(part)
    return nearest, False


def _merged(found: Candidates) -> Iterator[FoundInterval]:
    taken: dict[int, _Taken] = {}
    for index in _nearest_first(found):
        check()
        owner = int(found.owners[index])
        start, end = float(found.starts[index]), float(found.ends[index])
        if taken.setdefault(owner, _Taken()).take(start, end):
            distance = round(float(found.distances[index]), DECIMALS)
            yield FoundInterval(str(found.ids[owner]), start, end, distance, index)


class _Taken:
    """The parts of one clip that were kept."""

    def __init__(self) -> None:
        self._spans: list[tuple[float, float]] = []
        self._longest = 0.0

    def take(self, start: float, end: float) -> bool:
        """Keep a part, unless it overlaps one that was kept; returns whether it was kept."""
        first = bisect_left(self._spans, (start - self._longest, 0.0))
        for other_start, other_end in self._spans[first:]:
            if other_start >= end:
                break
            shared = min(end, other_end) - max(start, other_start)
            if shared > MAX_OVERLAP * min(end - start, other_end - other_start):
                return False
        insort(self._spans, (start, end))
        self._longest = max(self._longest, end - start)
        return True


def _nearest_first(found: Candidates) -> Iterator[int]:
    """Indices of the candidates by (distance, clip id, start), sorted as they are read."""
    distances = np.round(np.asarray(found.distances, dtype=np.float64), DECIMALS)
    low, count = -np.inf, FIRST_LOOK
    while low < np.inf:
        beyond = distances[distances > low]
        if not len(beyond):
            return
        high = np.partition(beyond, count - 1)[count - 1] if len(beyond) > count else np.inf
        chosen = np.flatnonzero((distances > low) & (distances <= high))
        yield from _in_order(found, distances, chosen).tolist()
        low, count = high, 4 * count


def _in_order(found: Candidates, distances: FloatArray, chosen: IntArray) -> IntArray:
    order = np.argsort(distances[chosen], kind="stable")
    if np.any(np.diff(distances[chosen][order]) == 0):
        # Only equal distances need the ids, which are slow to sort.
        ids = found.ids[found.owners[chosen]].astype(str)
        order = np.lexsort((found.ends[chosen], found.starts[chosen], ids, distances[chosen]))
    return np.asarray(chosen[order])
