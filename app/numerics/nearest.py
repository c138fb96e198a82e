"""The nearest of very many vectors, exactly: one float32 product, then a few float64 distances.

|q - x|^2 = |q|^2 - 2 q.x + |x|^2 needs one pass over the vectors but loses digits. The error has
a bound (Higham 2002, section 3.1: a sum of d products errs by at most d u |q| |x|, in any order).
So all vectors that can be among the nearest are collected, and their distances are computed again
in float64.

scikit-learn's NearestNeighbors is not used. It has no masks, no blocks that grow, and no pages
beyond a distance. Its brute force takes 3 times as long (11.5 ms against 3.8 for the 10 nearest
of 100,000 x 128, 13 against 4.2 among half of them; tests/bench/test_libraries.py).

Shapes: vectors n, dimensions d, results m. A row is the number of a vector, counted through all
blocks.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.deadline import check
from app.numerics.arrays import BoolArray, FloatArray, IntArray

DECIMALS = 9
"""Distances are rounded to this many decimals, so that rounding errors do not order them."""

UNIT = 2.0**-24
"""The largest relative error of one float32 operation (u)."""

GATHER_RATIO = 16
"""If a mask selects less than one vector in this many, only the selected vectors are copied and
multiplied. Else all are multiplied."""

MEASURED_AT_ONCE = 256
"""Vectors whose exact distances are computed at a time: their float64 copies (256 kB) stay in the
cache of a core."""

_ROUNDING = 10.0**-DECIMALS
_MAX_SPARE_ROWS = 4096
"""A search drops far rows as soon as it has this many more than 4 times the requested count."""
_MAX_FLOAT32 = float(np.finfo(np.float32).max)


@dataclass(frozen=True, slots=True)
class Block:
    """Some of the vectors to search.

    vectors: (n, d) float32, C-contiguous. squares: (n,) float32, their squared lengths.
    """

    vectors: FloatArray
    squares: FloatArray

    def __len__(self) -> int:
        return len(self.squares)

    @classmethod
    def of(cls, vectors: FloatArray) -> Block:
        """A block of `vectors` (n, d) of any float type; float32 C-contiguous ones are shared."""
        rows = np.ascontiguousarray(vectors, dtype=np.float32)
        return cls(rows, squared_lengths(rows))


def squared_lengths(vectors: FloatArray) -> FloatArray:
    """(n,) float32 squared Euclidean lengths of `vectors` (n, d), summed in float64."""
    return np.asarray(np.einsum("ij,ij->i", vectors, vectors, dtype=np.float64), dtype=np.float32)


def nearest(
    blocks: Sequence[Block],
    masks: Sequence[BoolArray | None],
    query: FloatArray,
    count: int,
    min_distance: float | None = None,
) -> tuple[IntArray, FloatArray]:
    """The rows (m,) and the rounded float64 Euclidean distances (m,) of the nearest vectors.

    masks: for each block (n,) which vectors are searched, None for all. query: (d,), used as
    float32. count: at least 1. min_distance: for the next page, the rounded distance of the last
    vector of the page before.

    The result has the `count` nearest vectors, and all others at the distance of the last of
    them. It can have some farther vectors too, and it is not sorted: the caller sorts it. With
    `min_distance`, nearer vectors are left out, all vectors at this distance are in the result,
    and the `count` nearest are counted among the farther ones.
    Raises DeadlineExceeded or ClientLeft (app.deadline).
    """
    query = np.asarray(query, dtype=np.float32)
    search = _Search(query, count, min_distance, _max_length(blocks))
    first = 0
    for block, mask in zip(blocks, masks, strict=True):
        check()
        search.add(block, mask, first)
        first += len(block)
    rows = search.rows()
    distances = distances_to(blocks, rows, query)
    if min_distance is not None:
        is_far = distances >= min_distance
        rows, distances = rows[is_far], distances[is_far]
    return rows, distances


def squared_distances(blocks: Sequence[Block], query: FloatArray) -> tuple[FloatArray, float]:
    """(n,) float32 squared distances of `query` (d,) to all vectors, and a bound of their error.

    The query is used as float32. By rounding, some squared distances can be negative.
    """
    query = np.asarray(query, dtype=np.float32)
    length = float(np.linalg.norm(query.astype(np.float64)))
    error = _max_error(len(query), length, _max_length(blocks))
    squares = np.empty(sum(len(block) for block in blocks), dtype=np.float32)
    first = 0
    for block in blocks:
        check()
        values = squares[first : first + len(block)]
        np.matmul(block.vectors, query, out=values)
        values *= -2.0
        values += block.squares
        first += len(block)
    squares += np.float32(length**2)
    return squares, error


def distances_to(blocks: Sequence[Block], rows: IntArray, query: FloatArray) -> FloatArray:
    """(m,) float64 distances of `query` (d,) to the vectors of `rows` (m,), rounded to DECIMALS.

    rows: ascending. The query is used as float32.
    """
    exact = np.asarray(query, dtype=np.float32).astype(np.float64)
    distances = np.empty(len(rows))
    # One buffer for all: numpy casts faster in a copy than in a subtraction.
    buffer = np.empty((min(len(rows), MEASURED_AT_ONCE), len(exact)))
    first = start = 0
    for block in blocks:
        stop = start + int(np.searchsorted(rows[start:], first + len(block)))
        own = rows[start:stop] - first
        for begin in range(0, len(own), MEASURED_AT_ONCE):
            some = own[begin : begin + MEASURED_AT_ONCE]
            apart = buffer[: len(some)]
            apart[...] = block.vectors.take(some, axis=0)
            apart -= exact
            np.vecdot(apart, apart, out=distances[start + begin : start + begin + len(some)])
        first, start = first + len(block), stop
    np.sqrt(distances, out=distances)
    return np.asarray(np.round(distances, DECIMALS, out=distances))


def gather(blocks: Sequence[Block], rows: IntArray) -> FloatArray:
    """(m, d) float32 the vectors of `rows` (m,), which may be in any order."""
    order = np.argsort(rows, kind="stable")
    ends = np.cumsum([len(block) for block in blocks])
    parts = np.split(rows[order], np.searchsorted(rows[order], ends[:-1]))
    firsts = [0, *ends[:-1].tolist()]
    vectors = [
        block.vectors.take(part - first, axis=0)
        for block, part, first in zip(blocks, parts, firsts, strict=True)
    ]
    # the inverse of the permutation `order`
    back = np.empty_like(order)
    back[order] = np.arange(len(order))
    return np.asarray(np.concatenate(vectors)[back])


def _max_length(blocks: Sequence[Block]) -> float:
    """The largest Euclidean length of a vector; 0 without vectors."""
    return float(np.sqrt(max((float(b.squares.max()) for b in blocks if len(b)), default=0.0)))


class _Search:
    """Collects, block after block, the rows that can be among the nearest.

    The value of a row is |x|^2 - 2 q.x in float32, which is its squared distance less |q|^2.
    """

    def __init__(
        self, query: FloatArray, count: int, min_distance: float | None, max_length: float
    ) -> None:
        self._minus_twice = query * np.float32(-2.0)  # exact, so that no error is added
        self._count = count
        self._square = float(query.astype(np.float64) @ query.astype(np.float64))
        self._error = _max_error(len(query), np.sqrt(self._square), max_length)
        self._bound = np.inf
        self._low, self._high = -np.inf, -np.inf
        if min_distance is not None:
            # A value below _low is nearer than `min_distance`. A value above _high is farther.
            # Between them, rounding decides, so these rows are measured in float64.
            self._low = self._value(min_distance - _ROUNDING) - self._error
            self._high = self._value(min_distance + _ROUNDING) + self._error
        self._rows: list[IntArray] = []
        self._values: list[FloatArray] = []
        self._row_count = 0

    def add(self, block: Block, mask: BoolArray | None, first: int) -> None:
        """Collect the rows of a block that can be among the nearest; `first` is its first row."""
        if mask is not None and np.count_nonzero(mask) * GATHER_RATIO < len(mask):
            chosen = np.flatnonzero(mask)
            values = block.vectors.take(chosen, axis=0) @ self._minus_twice
            values += block.squares[chosen]
            near = self._within_bounds(values)
            self._collect(first + chosen[near], values[near])
            return
        values = block.vectors @ self._minus_twice
        values += block.squares
        if mask is not None and not mask.all():
            values[~mask] = np.inf
        near = self._within_bounds(values)
        self._collect(first + near, values[near])

    def rows(self) -> IntArray:
        """All rows that can be among the nearest, ascending."""
        self._drop_far()
        return self._rows[0] if self._rows else np.zeros(0, dtype=np.int64)

    def _value(self, distance: float) -> float:
        """The value of a row at `distance` from the query."""
        return max(distance, 0.0) ** 2 - self._square

    def _within_bounds(self, values: FloatArray) -> IntArray:
        """The ascending indices of the `values` (n,) that are within the bounds."""
        if self._bound == np.inf:
            self._bound = self._bound_of(values)
        is_near = values <= self._bound
        if self._low > -np.inf:
            is_near &= values >= self._low
        return np.flatnonzero(is_near)

    def _collect(self, rows: IntArray, values: FloatArray) -> None:
        self._rows.append(rows)
        self._values.append(values)
        self._row_count += len(rows)
        if self._row_count > 4 * self._count + _MAX_SPARE_ROWS:
            self._drop_far()

    def _drop_far(self) -> None:
        """Drop the rows that cannot be among the `count` nearest beyond `min_distance`."""
        if len(self._rows) < 2:
            return
        rows, values = np.concatenate(self._rows), np.concatenate(self._values)
        self._bound = min(self._bound, self._bound_of(values))
        near = np.flatnonzero(values <= self._bound)
        self._rows, self._values, self._row_count = [rows[near]], [values[near]], len(near)

    def _bound_of(self, values: FloatArray) -> float:
        """A bound: no larger value is among the `count` nearest beyond `min_distance`.

        The bound allows for all rounding errors. A row that the mask leaves out has the value
        infinity.
        """
        beyond = values[values > self._high] if self._high > -np.inf else values
        if len(beyond) <= self._count:
            return _MAX_FLOAT32
        last = float(np.partition(beyond, self._count - 1)[self._count - 1])
        if last == np.inf:
            return _MAX_FLOAT32
        max_distance = np.sqrt(max(last + self._error + self._square, 0.0))
        return self._value(max_distance + 2 * _ROUNDING) + self._error


def _max_error(width: int, query_length: float, max_length: float) -> float:
    """A bound of the rounding error of a row's value.

    width: d. query_length: |q|. max_length: the largest length of a vector. The error comes
    from the product, the squares, the subtraction, and from computing this bound (1 %).
    """
    product = 2.0 * (width + 2) * UNIT * query_length * max_length
    return 1.01 * (product + 4.0 * UNIT * (max_length**2 + query_length**2))
