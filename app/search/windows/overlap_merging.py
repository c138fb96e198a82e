"""Parts of clips in order of distance, without parts that overlap a nearer part.

If two parts share more than MAX_OVERLAP of the shorter one, only the nearer part is a result
(greedy non-maximum suppression). Only the parts that a page needs are compared.
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
"""Largest shared duration of two results, as a share of the duration of the shorter one."""

FIRST_COUNT = 2048
"""Number of candidates that are sorted first; then four times as many, and so on."""


@dataclass(frozen=True, slots=True)
class Candidates:
    """Parts of clips and their distances, in any order.

    ids: (c,) clip ids; owners: (k,) for each part the index of its clip in `ids`; starts, ends:
    (k,) seconds; distances: (k,), finite.
    """

    ids: IdArray
    owners: IntArray
    starts: FloatArray
    ends: FloatArray
    distances: FloatArray

    def __len__(self) -> int:
        return len(self.owners)

    def with_distances(self, distances: FloatArray) -> Candidates:
        """The same parts with other distances (k,)."""
        return replace(self, distances=distances)


@dataclass(frozen=True, slots=True)
class FoundInterval:
    """A part of a clip, in seconds, and its distance; index: the index of the candidate."""

    clip_id: str
    start: float
    end: float
    distance: float
    index: int

    @property
    def key(self) -> str:
        """Sorts parts with equal distances, and identifies a part in a cursor."""
        return f"{self.clip_id} {self.start:013.4f} {self.end:013.4f}"


def merge_overlapping(
    candidates: Candidates,
    count: int,
    after: Position | None = None,
    max_distance: float = np.inf,
) -> tuple[list[FoundInterval], bool]:
    """The `count` nearest parts after a position, and whether others follow.

    max_distance: farther parts are left out.
    """
    last_seen = (-1.0, "") if after is None else (after.distance, after.clip_id)
    nearest: list[FoundInterval] = []
    for part in _merged(candidates):
        if part.distance > max_distance:
            break
        if (part.distance, part.key) > last_seen:
            if len(nearest) == count:
                return nearest, True
            nearest.append(part)
    return nearest, False


def _merged(candidates: Candidates) -> Iterator[FoundInterval]:
    """The results, the nearest first."""
    results: dict[int, _ClipResults] = {}
    for index in _nearest_first(candidates):
        check()
        owner = int(candidates.owners[index])
        start, end = float(candidates.starts[index]), float(candidates.ends[index])
        if results.setdefault(owner, _ClipResults()).add(start, end):
            distance = round(float(candidates.distances[index]), DECIMALS)
            yield FoundInterval(str(candidates.ids[owner]), start, end, distance, index)


class _ClipResults:
    """The results in one clip: parts that do not overlap, sorted by start."""

    def __init__(self) -> None:
        self._spans: list[tuple[float, float]] = []
        self._max_length = 0.0

    def add(self, start: float, end: float) -> bool:
        """Add a part if it does not overlap another one; return whether it was added."""
        # no part that begins earlier can reach `start`
        first = bisect_left(self._spans, (start - self._max_length, 0.0))
        for other_start, other_end in self._spans[first:]:
            if other_start >= end:
                break
            shared = min(end, other_end) - max(start, other_start)
            if shared > MAX_OVERLAP * min(end - start, other_end - other_start):
                return False
        insort(self._spans, (start, end))
        self._max_length = max(self._max_length, end - start)
        return True


def _nearest_first(candidates: Candidates) -> Iterator[int]:
    """Indices of the candidates by (distance, clip id, start), sorted batch by batch."""
    distances = np.round(np.asarray(candidates.distances, dtype=np.float64), DECIMALS)
    low, count = -np.inf, FIRST_COUNT
    while low < np.inf:
        beyond = distances[distances > low]
        if not len(beyond):
            return
        high = np.partition(beyond, count - 1)[count - 1] if len(beyond) > count else np.inf
        chosen = np.flatnonzero((distances > low) & (distances <= high))
        yield from _in_order(candidates, distances, chosen).tolist()
        low, count = high, 4 * count


def _in_order(candidates: Candidates, distances: FloatArray, chosen: IntArray) -> IntArray:
    order = np.argsort(distances[chosen], kind="stable")
    if np.any(np.diff(distances[chosen][order]) == 0):
        # Only equal distances need the ids, which are slow to sort.
        ids = candidates.ids[candidates.owners[chosen]].astype(str)
        order = np.lexsort(
            (candidates.ends[chosen], candidates.starts[chosen], ids, distances[chosen])
        )
    return np.asarray(chosen[order])
