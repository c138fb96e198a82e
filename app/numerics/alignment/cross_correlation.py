"""The largest value of the cross-correlation of two sequences (Sun 2011, equation 6).

scipy computes the Fourier transforms. Our part is that many candidates share one transform: 500
clips take 1.8 ms, a loop over scipy.signal.correlate 10.5, a loop over numpy.correlate 3.3
(tests/bench/test_libraries.py).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import scipy

from app.deadline import check
from app.numerics.arrays import FloatArray, IntArray

MAX_CELLS_AT_ONCE = 1 << 16
"""The largest number of numbers that are transformed at once (half a megabyte). So they stay in the
processor's cache."""

MAX_WASTE = 1.25
"""The largest ratio of the longest to the shortest transform of the candidates of a batch."""


def max_cross_correlations(query: FloatArray, candidates: Sequence[FloatArray]) -> FloatArray:
    """(candidates,) the maximum over all lags k of sum_i query[i + k] candidate[i], by FFT.

    query: (n,) and each candidate (m,), in the same unit, zero outside their ends. The paper
    pads the shorter sequence to the length of the longer one, which adds only zeros to the
    correlation. Lags at which the two do not overlap count too, so no value is negative.
    An empty sequence gives 0.
    """
    query = np.asarray(query, dtype=np.float64)
    lengths = np.array([len(candidate) for candidate in candidates], dtype=np.int64)
    values = np.zeros(len(lengths))
    if len(query):
        for batch in _batches(lengths, len(query)):
            check()
            values[batch] = _by_transform(query, [candidates[i] for i in batch])
    return values


def max_cross_correlations_of_rows(query: FloatArray, rows: FloatArray) -> FloatArray:
    """(candidates,) as `max_cross_correlations`, for short candidates of equal length.

    query: (n,). rows: (candidates, m). One matrix product computes all: n + m - 1 multiplications
    for each number of `rows`. From about 100 on, the transform is faster.
    """
    n, m = len(query), rows.shape[1]
    if not n or not m:
        return np.zeros(len(rows))
    # (m, n + m - 1): column k holds the query, shifted to begin m - 1 - k before the row
    shifted = np.zeros((m, n + m - 1))
    for i in range(m):
        shifted[i, m - 1 - i : m - 1 - i + n] = query
    return np.asarray((rows @ shifted).max(axis=1, initial=0.0))


def max_contained_cosines(query: FloatArray, candidates: Sequence[FloatArray]) -> FloatArray:
    """(candidates,) the largest cosine of the shorter sequence and a part of the longer one.

    query: (n,) and each candidate (m,). The part is as long as the shorter sequence, so the
    lengths do not matter: a part of a sequence has the cosine 1 with it. This is normalized
    cross-correlation at all lags of full overlap. An empty sequence gives 0.
    """
    values = np.zeros(len(candidates))
    for number, candidate in enumerate(candidates):
        if number % 256 == 0:
            check()
        short, long = sorted((query, candidate), key=len)
        if len(short):
            values[number] = _contained_cosine(short.astype(np.float64), long.astype(np.float64))
    return values


def _contained_cosine(short: FloatArray, long: FloatArray) -> float:
    products = scipy.signal.correlate(long, short, "valid")
    squares = np.concatenate([[0.0], np.cumsum(np.square(long))])
    powers = (squares[len(short) :] - squares[: -len(short)]) * float(np.square(short).sum())
    return float((products / np.sqrt(np.maximum(powers, 1e-24))).max())


def _batches(lengths: IntArray, n: int) -> Iterator[IntArray]:
    """Indices of candidates whose transforms are about equally long, without empty candidates.

    lengths: (candidates,). n: the length of the query.
    """
    order = np.argsort(lengths, kind="stable")
    ordered = lengths[order]
    first = int(np.searchsorted(ordered, 0, side="right"))
    while first < len(order):
        # A transform has about n + m numbers. All transforms of a batch get the longest length.
        max_length = int(MAX_WASTE * (n + ordered[first])) - n
        stop = int(np.searchsorted(ordered, max(max_length, ordered[first]), side="right"))
        count = min(stop - first, max(1, MAX_CELLS_AT_ONCE // (n + max_length)))
        yield order[first : first + count]
        first += count


def _by_transform(query: FloatArray, candidates: list[FloatArray]) -> FloatArray:
    """(c,) the maxima of c candidates of similar length, none empty."""
    max_length = max(len(candidate) for candidate in candidates)
    # The correlation is circular, but long enough for all lags, so the ends do not overlap.
    length = scipy.fft.next_fast_len(len(query) + max_length - 1, real=True)
    padded = np.zeros((len(candidates), length))
    for row, candidate in zip(padded, candidates, strict=True):
        row[: len(candidate)] = candidate
    spectra = scipy.fft.rfft(padded, axis=1)
    spectra *= scipy.fft.rfft(query, length).conj()
    return np.asarray(scipy.fft.irfft(spectra, length, overwrite_x=True).max(axis=1, initial=0.0))
