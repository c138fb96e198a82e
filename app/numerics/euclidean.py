"""Euclidean distances of all pairs of rows by one matrix product, without its rounding.

|a - b|^2 = |a|^2 + |b|^2 - 2 a.b loses its digits where a and b are close: equal rows would
be apart. Those few pairs are subtracted and squared instead.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.numerics.arrays import FloatArray

TOO_CLOSE = 1e-4
"""Squared distances below this share of the squared lengths are taken again."""

RETAKEN_AT_ONCE = 10_000
"""Pairs; bounds memory."""


def squared_lengths(rows: FloatArray) -> FloatArray:
    """(k,) of rows (k, d)."""
    return np.asarray(np.einsum("kd,kd->k", rows, rows))


def distances(
    rows: FloatArray,
    others: FloatArray,
    squares: FloatArray,
    parts: Sequence[slice] = (slice(None),),
) -> FloatArray:
    """(n, k) float32 Euclidean distances of `rows` (n, d) to `others` (k, d), both float32.

    squares: (k,) `squared_lengths(others)`, which a caller has use for more than once; parts:
    of the k that are multiplied by themselves. The last bits of a product may depend on how
    large it is, those of a part's distances so only on the part.
    """
    apart = squared_distances(rows, others, squares, parts)
    return np.asarray(np.sqrt(apart, out=apart))


def squared_distances(
    rows: FloatArray,
    others: FloatArray,
    squares: FloatArray,
    parts: Sequence[slice] = (slice(None),),
) -> FloatArray:
    """(n, k) float32 squares of `distances`."""
    twice = -2.0 * rows
    apart = np.empty((len(rows), len(others)), dtype=twice.dtype)
    for part in parts:
        np.matmul(twice, others[part].T, out=apart[:, part])
    apart += squared_lengths(rows)[:, None]
    apart += squares
    _retake_close(apart, rows, others, TOO_CLOSE * squares)
    return np.asarray(apart)


def _retake_close(
    apart: FloatArray, rows: FloatArray, others: FloatArray, least: FloatArray
) -> None:
    """Compute anew, in place, the (n, k) squared distances that are not above `least` (k,)."""
    # flat: numpy's two-dimensional nonzero is many times slower
    row, other = np.divmod(np.flatnonzero(apart <= least), apart.shape[1])
    for first in range(0, len(row), RETAKEN_AT_ONCE):
        some = slice(first, first + RETAKEN_AT_ONCE)
        difference = rows[row[some]] - others[other[some]]
        apart[row[some], other[some]] = squared_lengths(difference)
