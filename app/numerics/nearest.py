"""The nearest of very many vectors, exactly: one float32 product, then a few true distances.

|q - x|^2 = |q|^2 - 2 q.x + |x|^2 costs one pass over the vectors but loses digits. How many
is bounded (Higham 2002, section 3.1: a sum of d products errs by at most d u |q| |x|, in any
order), so whatever could be among the nearest is kept, and measured again in float64.

scikit-learn's NearestNeighbors stays out: it knows no masks, no blocks that grow, and no pages
beyond a distance. Its brute force takes 3 times as long (11.5 ms against 3.8 for the 10 nearest
of 100,000 x 128, 13 against 4.2 among half of them; tests/bench/test_libraries.py).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.deadline import check
from app.numerics.arrays import BoolArray, FloatArray, IntArray

DECIMALS = 9
"""Distances are rounded to so many decimals; those closer than that are equal."""

UNIT = 2.0**-24
"""Largest relative error of one float32 operation."""

FEW = 16
"""Vectors are gathered where less than one in so many is asked for; else all are multiplied."""

_ROUNDING = 10.0**-DECIMALS
_HELD = 4096
"""Rows that are held before their number is looked at."""
_LARGEST = float(np.finfo(np.float32).max)


@dataclass(frozen=True, slots=True)
class Block:
    """Vectors (n, d) float32 C-contiguous, and the squares (n,) float32 of their lengths."""

    vectors: FloatArray
    squares: FloatArray

    def __len__(self) -> int:
        return len(self.squares)

    @classmethod
    def of(cls, vectors: FloatArray) -> Block:
        """A block of any vectors (n, d)."""
        rows = np.ascontiguousarray(vectors, dtype=np.float32)
        return cls(rows, squared_lengths(rows))


def squared_lengths(vectors: FloatArray) -> FloatArray:
    """(n,) float32 squared lengths of `vectors` (n, d), summed in float64."""
    return np.asarray(np.einsum("ij,ij->i", vectors, vectors, dtype=np.float64), dtype=np.float32)


def nearest(
    blocks: Sequence[Block],
    masks: Sequence[BoolArray | None],
    query: FloatArray,
    count: int,
    least: float | None = None,
) -> tuple[IntArray, FloatArray]:
    """Rows (m,) and rounded Euclidean distances (m,) float64 of the vectors nearest to `query`.

    Rows count through all blocks; masks: (n,) of each block, the rows that are meant, or None
    for all. query: (d,), taken as float32. Given are, in no order, the `count` nearest and
    whatever is as far as the last of them; with `least`, a rounded distance, the `count`
    nearest of those that are farther, and all that are exactly so far.
    """
    query = np.asarray(query, dtype=np.float32)
    search = _Search(query, count, least, _longest(blocks))
    first = 0
    for block, mask in zip(blocks, masks, strict=True):
        check()
        search.look(block, mask, first)
        first += len(block)
    rows = search.found()
    distances = distances_to(blocks, rows, query)
    if least is not None:
        rows, distances = rows[distances >= least], distances[distances >= least]
    return rows, distances


def squared_distances(blocks: Sequence[Block], query: FloatArray) -> tuple[FloatArray, float]:
    """(n,) float32 squared distances of `query` (d,) to all vectors, and their largest error.

    Some may be below zero, by rounding.
    """
    query = np.asarray(query, dtype=np.float32)
    length = float(np.linalg.norm(query.astype(np.float64)))
    error = _largest_error(len(query), length, _longest(blocks))
    found = np.empty(sum(len(block) for block in blocks), dtype=np.float32)
    first = 0
    for block in blocks:
        check()
        values = found[first : first + len(block)]
        np.matmul(block.vectors, query, out=values)
        values *= -2.0
        values += block.squares
        first += len(block)
    found += np.float32(length**2)
    return found, error


def distances_to(blocks: Sequence[Block], rows: IntArray, query: FloatArray) -> FloatArray:
    """(m,) float64 rounded distances of `query` (d,) to the vectors of ascending `rows` (m,)."""
    exact = np.asarray(query, dtype=np.float32).astype(np.float64)
    distances = np.empty(len(rows))
    first = start = 0
    for block in blocks:
        stop = start + int(np.searchsorted(rows[start:], first + len(block)))
        if stop > start:
            apart = block.vectors.take(rows[start:stop] - first, axis=0).astype(np.float64)
            apart -= exact
            distances[start:stop] = np.sqrt(np.vecdot(apart, apart))
        first, start = first + len(block), stop
    return np.asarray(np.round(distances, DECIMALS, out=distances))


def gather(blocks: Sequence[Block], rows: IntArray) -> FloatArray:
    """(m, d) float32 vectors of `rows` (m,), in any order."""
    order = np.argsort(rows, kind="stable")
    ends = np.cumsum([len(block) for block in blocks])
    parts = np.split(rows[order], np.searchsorted(rows[order], ends[:-1]))
    firsts = [0, *ends[:-1].tolist()]
    found = [
        block.vectors.take(part - first, axis=0)
        for block, part, first in zip(blocks, parts, firsts, strict=True)
    ]
    back = np.empty_like(order)
    back[order] = np.arange(len(order))
    return np.asarray(np.concatenate(found)[back])


def _longest(blocks: Sequence[Block]) -> float:
    return float(np.sqrt(max((float(b.squares.max()) for b in blocks if len(b)), default=0.0)))


class _Search:
    """What may be among the nearest, block after block.

    A row's value is |x|^2 - 2 q.x, as float32 sees it: its squared distance less |q|^2.
    """

    def __init__(self, query: FloatArray, count: int, least: float | None, longest: float) -> None:
        self._query = query
        self._count = count
        self._square = float(query.astype(np.float64) @ query.astype(np.float64))
        self._error = _largest_error(len(query), np.sqrt(self._square), longest)
        self._bound = np.inf
        self._low, self._high = -np.inf, -np.inf
        if least is not None:
            self._low = self._value(least - _ROUNDING) - self._error
            self._high = self._value(least + _ROUNDING) + self._error
        self._rows: list[IntArray] = []
        self._values: list[FloatArray] = []
        self._held = 0

    def look(self, block: Block, mask: BoolArray | None, first: int) -> None:
        """Keep what may be among the nearest of a block whose first row is row `first`."""
        if mask is not None and np.count_nonzero(mask) * FEW < len(mask):
            chosen = np.flatnonzero(mask)
            values = block.squares[chosen] - 2.0 * (
                block.vectors.take(chosen, axis=0) @ self._query
            )
            kept = self._may_be(values)
            self._hold(first + chosen[kept], values[kept])
            return
        values = block.vectors @ self._query
        values *= -2.0
        values += block.squares
        if mask is not None:
            values[~mask] = np.inf
        kept = self._may_be(values)
        self._hold(first + kept, values[kept])

    def found(self) -> IntArray:
        """Ascending rows of all that may be among the nearest."""
        self._narrow()
        return self._rows[0] if self._rows else np.zeros(0, dtype=np.int64)

    def _value(self, distance: float) -> float:
        return max(distance, 0.0) ** 2 - self._square

    def _may_be(self, values: FloatArray) -> IntArray:
        """Indices of the `values` (n,) that are within the bounds, ascending."""
        if self._bound == np.inf:
            self._bound = self._bound_of(values)
        keep = values <= self._bound
        if self._low > -np.inf:
            keep &= values >= self._low
        return np.flatnonzero(keep)

    def _hold(self, rows: IntArray, values: FloatArray) -> None:
        self._rows.append(rows)
        self._values.append(values)
        self._held += len(rows)
        if self._held > 4 * self._count + _HELD:
            self._narrow()

    def _narrow(self) -> None:
        """Drop what `count` others, farther than `least`, are surely nearer than."""
        if len(self._rows) < 2:
            return
        rows, values = np.concatenate(self._rows), np.concatenate(self._values)
        self._bound = min(self._bound, self._bound_of(values))
        kept = np.flatnonzero(values <= self._bound)
        self._rows, self._values, self._held = [rows[kept]], [values[kept]], len(kept)

    def _bound_of(self, values: FloatArray) -> float:
        """Above it, no value is among the `count` nearest beyond `least`, whatever the rounding.

        A value of infinity stands for a row that is not meant.
        """
        beyond = values[values > self._high] if self._high > -np.inf else values
        if len(beyond) <= self._count:
            return _LARGEST
        last = float(np.partition(beyond, self._count - 1)[self._count - 1])
        if last == np.inf:
            return _LARGEST
        farthest = np.sqrt(max(last + self._error + self._square, 0.0))
        return self._value(farthest + 2 * _ROUNDING) + self._error


def _largest_error(width: int, query: float, longest: float) -> float:
    """Of a row's value: the product's, the square's, the subtraction's and the bound's rounding."""
    product = 2.0 * (width + 2) * UNIT * query * longest
    return 1.01 * (product + 4.0 * UNIT * (longest**2 + query**2))
