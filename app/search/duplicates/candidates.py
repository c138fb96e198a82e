"""Clips that may be near-duplicates: the nearest by motion vector, and by their moments.

Motion vectors are compared by brute force, block by block. There are about ten times as many
moments, so they are put into cells around some of them, and each is compared with those of the two
nearest cells: copies lie much closer together than the sizes of cells, and have several moments.
The work is about n * sqrt(n).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from app.analysis.descriptors.moments import WIDTH, mirrored
from app.deadline import check
from app.numerics.arrays import FloatArray, IntArray
from app.search.index.rows import Layout

MOMENTS = Layout(("moments",), WIDTH, facts=1, several=True)
"""The layout of an index of moments; the fact is the time in seconds."""

NEAREST = 6
"""Clips that are looked at more closely, of each way to find them."""

PER_MOMENT = 3
"""Nearest moments of other clips that each moment contributes."""

MAX_MOMENT_DISTANCE = 0.14
"""Moments farther apart belong to different takes."""

CELL = 1500
"""Moments in a cell, about."""

CELLS_OF_A_MOMENT = 2
QUERIES_AT_ONCE = 512
"""Rows of one matrix of distances, to bound the memory."""

_SEED = 20240


@dataclass(frozen=True, slots=True)
class Candidate:
    """Two clips by their numbers, and whether the second one is to be mirrored."""

    one: int
    other: int
    is_mirrored: bool


def by_vectors(vectors: FloatArray, asked: IntArray) -> set[Candidate]:
    """For the clips `asked` (a,), the NEAREST others by motion vectors (n, d)."""
    vectors = np.ascontiguousarray(vectors, dtype=np.float32)
    squares = np.einsum("nd,nd->n", vectors, vectors)
    count = min(NEAREST, len(vectors) - 1)
    found: set[Candidate] = set()
    if count < 1:
        return found
    for first in range(0, len(asked), QUERIES_AT_ONCE):
        check()
        own = asked[first : first + QUERIES_AT_ONCE]
        # the squared distances but for a constant of each row
        away = squares - 2.0 * (vectors[own] @ vectors.T)
        away[np.arange(len(own)), own] = np.inf
        nearest = np.argpartition(away, count - 1, axis=1)[:, :count]
        found.update(_pairs(np.repeat(own, count), nearest.ravel(), is_mirrored=False))
    return found


def by_moments(vectors: FloatArray, owners: IntArray, asked: IntArray) -> set[Candidate]:
    """For the clips `asked`, the NEAREST others by moments, as they are and mirrored.

    vectors: (m, d) of all moments; owners: (m,) the numbers of their clips.
    """
    rows = np.flatnonzero(np.isin(owners, asked))
    cells = _Cells(np.ascontiguousarray(vectors, dtype=np.float32))
    found: set[Candidate] = set()
    for is_mirrored in (False, True):
        queries = cells.vectors[rows]
        queries = mirrored(queries) if is_mirrored else queries
        sources, others, away = cells.nearest(queries, owners[rows], owners)
        found.update(_best(sources, others, away, is_mirrored=is_mirrored))
    return found


def _best(
    sources: IntArray, others: IntArray, away: FloatArray, *, is_mirrored: bool
) -> Iterator[Candidate]:
    """The NEAREST different others of each source, from pairs with distances."""
    order = np.lexsort((away, sources))
    seen: dict[int, set[int]] = {}
    for one, other in zip(sources[order].tolist(), others[order].tolist(), strict=True):
        known = seen.setdefault(one, set())
        if len(known) < NEAREST:
            known.add(other)
    for one, known in seen.items():
        numbers = np.array(sorted(known), dtype=np.int64)
        yield from _pairs(np.full(len(numbers), one), numbers, is_mirrored=is_mirrored)


def _pairs(ones: IntArray, others: IntArray, *, is_mirrored: bool) -> Iterator[Candidate]:
    """Each pair once, the smaller number first: a mirrored pair is the same both ways."""
    low, high = np.minimum(ones, others), np.maximum(ones, others)
    for one, other in zip(low.tolist(), high.tolist(), strict=True):
        yield Candidate(one, other, is_mirrored)


class _Cells:
    """Vectors (m, d), each in the cell of the nearest of some centers."""

    def __init__(self, vectors: FloatArray) -> None:
        self.vectors = vectors
        self._squares = np.einsum("nd,nd->n", vectors, vectors)
        count = max(1, len(vectors) // CELL)
        drawn = np.random.RandomState(_SEED).choice(len(vectors), count, replace=False)
        self._centers = vectors[np.sort(drawn)]
        cells = self._cells_of(vectors, 1)[:, 0]
        self._members = np.argsort(cells, kind="stable")
        self._starts = np.searchsorted(cells[self._members], np.arange(count + 1))

    def nearest(
        self, queries: FloatArray, own: IntArray, owners: IntArray
    ) -> tuple[IntArray, IntArray, FloatArray]:
        """Pairs of clips with near moments: sources, others and distances, all (p,).

        queries: (q, d). own: (q,) the clips of the queries. owners: (m,) of the vectors. Each query
        contributes at most PER_MOMENT pairs in each cell.
        """
        found: list[tuple[IntArray, IntArray, FloatArray]] = []
        for some in self._cells_of(queries, min(CELLS_OF_A_MOMENT, len(self._centers))).T:
            order = np.argsort(some, kind="stable")
            bounds = np.searchsorted(some[order], np.arange(len(self._centers) + 1))
            for cell in range(len(self._centers)):
                inside = order[bounds[cell] : bounds[cell + 1]]
                for first in range(0, len(inside), QUERIES_AT_ONCE):
                    check()
                    rows = inside[first : first + QUERIES_AT_ONCE]
                    found.append(self._in_cell(cell, queries[rows], own[rows], owners))
        if not found:
            return np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0)
        sources, others, away = (np.concatenate(parts) for parts in zip(*found, strict=True))
        return sources, others, away

    def _in_cell(
        self, cell: int, queries: FloatArray, own: IntArray, owners: IntArray
    ) -> tuple[IntArray, IntArray, FloatArray]:
        members = self._members[self._starts[cell] : self._starts[cell + 1]]
        squares = np.einsum("nd,nd->n", queries, queries)[:, None] + self._squares[members]
        away = squares - 2.0 * (queries @ self.vectors[members].T)
        away[own[:, None] == owners[members]] = np.inf
        count = min(PER_MOMENT, len(members))
        nearest = np.argpartition(away, count - 1, axis=1)[:, :count] if count else members[:0]
        squared = np.take_along_axis(away, nearest, axis=1)
        is_near = squared <= MAX_MOMENT_DISTANCE**2
        sources = np.broadcast_to(own[:, None], squared.shape)[is_near]
        return sources, owners[members[nearest[is_near]]], squared[is_near]

    def _cells_of(self, vectors: FloatArray, count: int) -> IntArray:
        """(n, count) the nearest cells of each vector, in any order."""
        squares = np.einsum("nd,nd->n", self._centers, self._centers)
        found = np.empty((len(vectors), count), dtype=np.int64)
        for first in range(0, len(vectors), QUERIES_AT_ONCE * 8):
            check()
            part = slice(first, first + QUERIES_AT_ONCE * 8)
            away = squares - 2.0 * (vectors[part] @ self._centers.T)
            found[part] = np.argpartition(away, count - 1, axis=1)[:, :count]
        return found
