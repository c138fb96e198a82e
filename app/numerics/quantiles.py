"""Quantiles and medians along the first axis, bit for bit those of numpy, in a third of the time.

numpy's functions take about 80 microseconds for a hundred numbers, most of it for options that are
not needed here. The analysis of one clip asks for sixty of them.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.numerics.arrays import FloatArray


def median(values: FloatArray) -> FloatArray:
    """(...) the medians of `values` (n, ...), n >= 1, float64 without NaN."""
    low, high = (len(values) - 1) // 2, len(values) // 2
    ordered = np.partition(values, (low, high), axis=0)
    return np.asarray((ordered[low] + ordered[high]) / 2)


def quantile(values: FloatArray, share: float) -> FloatArray:
    """(...) the quantile `share` (0..1) of `values` (n, ...), n >= 1, float64 without NaN.

    Between two values, it is interpolated linearly (numpy's default).
    """
    return quantiles(values, (share,))[0]


def quantiles(values: FloatArray, shares: Sequence[float]) -> list[FloatArray]:
    """For each of `shares` the `quantile`, (...)."""
    places = [share * (len(values) - 1) for share in shares]
    lows = [int(place) for place in places]
    highs = [min(low + 1, len(values) - 1) for low in lows]
    ordered = np.partition(values, sorted({*lows, *highs}), axis=0)
    found = []
    for place, low, high in zip(places, lows, highs, strict=True):
        weight, rise = place - low, ordered[high] - ordered[low]
        # as numpy does, from the nearer end, so that the result rises with the share
        at = ordered[low] + rise * weight if weight < 0.5 else ordered[high] - rise * (1 - weight)
        found.append(np.asarray(at))
    return found


def quantiles_of_sorted(ordered: FloatArray, shares: FloatArray) -> FloatArray:
    """(k, ...) the quantile `shares[i]` (0..1) of `ordered[i]` along its last axis.

    shares: (k,). ordered: (k, ..., n), n >= 1, sorted along its last axis, without NaN. NumPy
    sorts many short rows in less time than it needs to find the places of one.
    """
    places = shares * (ordered.shape[-1] - 1)
    lows = places.astype(np.int64)
    highs = np.minimum(lows + 1, ordered.shape[-1] - 1)
    rows = np.arange(len(ordered))
    low, high = ordered[rows, ..., lows], ordered[rows, ..., highs]
    weights = (places - lows).reshape(-1, *[1] * (ordered.ndim - 2))
    rise = high - low
    # as numpy does, from the nearer end, so that the result rises with the share
    return np.asarray(np.where(weights < 0.5, low + rise * weights, high - rise * (1 - weights)))
