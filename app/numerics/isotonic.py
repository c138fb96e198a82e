"""Isotonic regression: the rising curve nearest to points, by pooling neighbors that fall."""

from __future__ import annotations

import numpy as np
import scipy

from app.numerics.arrays import FloatArray


def rising_means(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Mean x (k,), strictly rising, and mean y (k,), rising, of the pools of points (n,), n >= 1.

    scipy pools adjacent violators. A caller interpolates between the pools.
    """
    values, member, counts = np.unique(x, return_inverse=True, return_counts=True)
    weights = counts.astype(np.float64)
    means = np.bincount(member, weights=np.asarray(y, dtype=np.float64)) / weights
    pools = scipy.optimize.isotonic_regression(means, weights=weights)
    starts = pools.blocks[:-1]
    centers = np.add.reduceat(values * weights, starts) / np.add.reduceat(weights, starts)
    return centers, np.asarray(pools.x[starts])
