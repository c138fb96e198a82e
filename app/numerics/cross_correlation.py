"""The largest value of the cross-correlation of two sequences (Sun 2011, equation 6)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft

from app.numerics.arrays import FloatArray

BATCH = 512
"""Candidates transformed at once; bounds the memory."""


def max_cross_correlation(a: FloatArray, b: FloatArray) -> float:
    """max over lags k of sum_i a[i + k] b[i]; `a` (n,) and `b` (m,), zero outside their ends."""
    return float(max_cross_correlations(a, [b])[0])


def max_cross_correlations(query: FloatArray, candidates: Sequence[FloatArray]) -> FloatArray:
    """(candidates,) max_cross_correlation of `query` (n,) with each candidate (m,), by FFT.

    Padding the shorter to the length of the longer, as the paper does, adds only zeros to
    the correlation; all lags are looked at, also those where the two do not meet, so that
    no value is below 0. Empty sequences give 0.
    """
    query = np.asarray(query, dtype=np.float64)
    values = np.zeros(len(candidates))
    by_length = np.argsort([len(candidate) for candidate in candidates], kind="stable")
    for first in range(0, len(by_length), BATCH):
        chosen = by_length[first : first + BATCH]
        values[chosen] = _batch(query, [candidates[i] for i in chosen])
    return values


def _batch(query: FloatArray, candidates: list[FloatArray]) -> FloatArray:
    """Maxima for candidates of similar length: (c,)."""
    longest = max(len(candidate) for candidate in candidates)
    if not longest or not len(query):
        return np.zeros(len(candidates))
    lags = len(query) + longest - 1
    length = next_fast_len(lags, real=True)
    padded = np.zeros((len(candidates), longest))
    for row, candidate in zip(padded, candidates, strict=True):
        row[: len(candidate)] = candidate
    # (c, length) circular correlation; `length` >= lags, so nothing wraps onto anything
    spectra = rfft(padded[:, ::-1], length) * rfft(query, length)
    return np.asarray(irfft(spectra, length)[:, :lags].max(axis=1, initial=0.0))
