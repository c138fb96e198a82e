"""Euclidean distances of all pairs of rows, by one matrix product but without its rounding error.

|a - b|^2 = |a|^2 + |b|^2 - 2 a.b loses digits if a and b are close: equal rows would have a
distance above 0. These few pairs are computed again by subtraction. So the result is as exact as
that of `scipy.spatial.distance.cdist`, which subtracts all pairs. cdist has no single precision,
and takes 3 to 5 times as long for rows of 39 numbers or more (257 x 257 rows of 128: 2.4 ms
against 0.5). cdist is faster, by microseconds, for one row or for points of the plane.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.numerics.arrays import FloatArray, IntArray

TOO_CLOSE_SINGLE = 1e-4
"""float32 squared distances up to this share of the squared length are computed again."""

TOO_CLOSE_DOUBLE = 1e-8
"""The same for float64."""

MAX_RECOMPUTED_PAIRS = 10_000
"""The largest number of pairs that are computed again at a time. It bounds the memory."""


def squared_lengths(rows: FloatArray) -> FloatArray:
    """(..., k) squared Euclidean lengths of `rows` (..., k, d), in the precision of `rows`."""
    return np.asarray(np.einsum("...d,...d->...", rows, rows))


def distances(
    rows: FloatArray,
    others: FloatArray,
    squares: FloatArray | None = None,
    parts: Sequence[slice] = (slice(None),),
) -> FloatArray:
    """(..., n, k) Euclidean distances of `rows` (..., n, d) to `others` (..., k, d).

    The parameters, precision and exactness are those of `squared_distances`.
    """
    between = squared_distances(rows, others, squares, parts)
    return np.asarray(np.sqrt(between, out=between))


def squared_distances(
    rows: FloatArray,
    others: FloatArray,
    squares: FloatArray | None = None,
    parts: Sequence[slice] = (slice(None),),
) -> FloatArray:
    """(..., n, k) squared Euclidean distances of `rows` (..., n, d) to `others` (..., k, d).

    rows, others: float32 or float64, in the same unit; their leading axes are broadcast. The
    result has the wider of the two types. Equal rows have distance 0, and no distance is
    negative. squares: (..., k) `squared_lengths(others)`, if the caller has them. parts: slices
    that cover the k others; each is multiplied alone. The last bits of a matrix product can
    depend on its size. With parts, the last bits of a distance depend only on its own part.
    """
    squares = squared_lengths(others) if squares is None else squares
    twice = -2.0 * rows
    lead = np.broadcast_shapes(rows.shape[:-2], others.shape[:-2])
    shape = (*lead, rows.shape[-2], others.shape[-2])
    between = np.empty(shape, dtype=np.result_type(twice, others))
    for part in parts:
        np.matmul(twice, others[..., part, :].swapaxes(-1, -2), out=between[..., part])
    # (..., n, k) -2 a.b + |a|^2 + |b|^2, added in place because the table is the largest array
    between += squared_lengths(rows)[..., None]
    between += squares[..., None, :]
    share = TOO_CLOSE_SINGLE if between.dtype == np.float32 else TOO_CLOSE_DOUBLE
    close = np.flatnonzero(between <= (share * squares)[..., None, :])
    for first in range(0, len(close), MAX_RECOMPUTED_PAIRS):
        _subtract(between, rows, others, close[first : first + MAX_RECOMPUTED_PAIRS])
    return np.asarray(between)


def _subtract(between: FloatArray, rows: FloatArray, others: FloatArray, pairs: IntArray) -> None:
    """Compute the squared distances of `pairs` again by subtraction, in place in `between`.

    between: (..., n, k). pairs: (p,) positions in the flat array; numpy finds them many times
    faster than indices along each axis.
    """
    *lead, row, other = np.unravel_index(pairs, between.shape)
    rows = np.broadcast_to(rows, (*between.shape[:-2], *rows.shape[-2:]))
    others = np.broadcast_to(others, (*between.shape[:-2], *others.shape[-2:]))
    difference = rows[(*lead, row)] - others[(*lead, other)]
    between[(*lead, row, other)] = squared_lengths(difference)
