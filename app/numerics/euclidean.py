"""Euclidean distances of all pairs of rows by one matrix product, without its rounding.

|a - b|^2 = |a|^2 + |b|^2 - 2 a.b loses its digits where a and b are close: equal rows would
be apart. Those few pairs are subtracted and squared instead.
"""

from __future__ import annotations

import numpy as np

from app.numerics.arrays import FloatArray

TOO_CLOSE = 1e-4
"""Squared distances below this share of the squared lengths are taken again."""

RETAKEN_AT_ONCE = 10_000
"""Pairs; bounds memory."""


def squared_lengths(rows: FloatArray) -> FloatArray:
    """(k,) of rows (k, d)."""
    return np.asarray(np.einsum("kd,kd->k", rows, rows))


def distances(rows: FloatArray, others: FloatArray, squares: FloatArray) -> FloatArray:
    """(n, k) float32 Euclidean distances of `rows` (n, d) to `others` (k, d), both float32.

    squares: (k,) `squared_lengths(others)`, which a caller has use for more than once.
    """
    apart = squared_distances(rows, others, squares)
    return np.asarray(np.sqrt(apart, out=apart))


def squared_distances(rows: FloatArray, others: FloatArray, squares: FloatArray) -> FloatArray:
    """(n, k) float32 squares of `distances`."""
    apart = (-2.0 * rows) @ others.T
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
