"""Hits in groups: the best hit of each, and an order in which neighbors are unlike each other.

The order is maximal marginal relevance (Carbonell and Goldstein 1998, "The use of MMR, diversity-
based reranking"): each time the hit with the largest (1 - d) score - d likeness is next, where
likeness is that to the most similar hit before it.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Protocol

import numpy as np

from app.numerics.arrays import FloatArray, IntArray
from app.search.ranking.cursor import Position
from app.search.ranking.ranking import IdArray, Page

FIRST_READ = 300
"""Hits of a ranking that are read first. If they are not enough, four times as many follow."""


class InPages(Protocol):
    """A ranking that is read page by page."""

    def page(self, after: Position | None, limit: int) -> Page:
        """The first `limit` clips after a position."""


def in_pages(
    ranking: InPages, max_distance: float = np.inf
) -> Iterator[tuple[IdArray, FloatArray]]:
    """The ids (k,) and distances (k,) of a ranking in order, as far as `max_distance`, inclusive.

    Only as much of the ranking is sorted as is read.
    """
    read, count = 0, FIRST_READ
    while True:
        page = ranking.page(None, count)
        ids, distances = page.ids[read:], page.distances[read:]
        near = distances <= max_distance
        yield ids[near], distances[near]
        if not page.more or not near.all():
            return
        read, count = len(page.ids), 4 * count


def firsts(codes: IntArray, seen: set[int]) -> IntArray:
    """The places of the first of each group in `codes` (k,), without groups in `seen`, ascending.

    A negative code is a group of its own. The groups that are found are added to `seen`.
    """
    places = []
    for place, code in enumerate(codes.tolist()):
        if code >= 0 and code in seen:
            continue
        seen.add(code)
        places.append(place)
    return np.array(places, dtype=np.int64)


def diverse_order(scores: FloatArray, likeness: FloatArray, diversity: float) -> IntArray:
    """(k,) the hits in the order of maximal marginal relevance; of equal ones the first is first.

    scores: (k,) 0..1; likeness: (k, k) 0..1, symmetric; diversity: d, 0 keeps the order of scores.
    """
    nearest = np.zeros(len(scores))
    rest = np.ones(len(scores), dtype=bool)
    order = np.empty(len(scores), dtype=np.int64)
    for place in range(len(scores)):
        worth = (1.0 - diversity) * scores - diversity * nearest
        chosen = int(np.argmax(np.where(rest, worth, -np.inf)))
        order[place], rest[chosen] = chosen, False
        nearest = np.maximum(nearest, likeness[chosen])
    return order
