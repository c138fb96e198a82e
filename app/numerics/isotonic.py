"""Isotonic regression: the rising curve that is nearest to given points."""

from __future__ import annotations

import numpy as np
import scipy

from app.numerics.arrays import FloatArray


def rising_means(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The mean x (k,) and mean y (k,) of the k pools of an isotonic regression of y on x.

    x, y: (n,) the points, at least one, in any order. Points of equal x are averaged first. Then
    scipy pools adjacent points with falling y (least squares). The mean x of the pools rises
    strictly, and their mean y rises. The caller interpolates between the pools.
    """
    values, member, counts = np.unique(x, return_inverse=True, return_counts=True)
    weights = counts.astype(np.float64)
    means = np.bincount(member, weights=np.asarray(y, dtype=np.float64)) / weights
    pools = scipy.optimize.isotonic_regression(means, weights=weights)
    starts = pools.blocks[:-1]
    centers = np.add.reduceat(values * weights, starts) / np.add.reduceat(weights, starts)
    return centers, np.asarray(pools.x[starts])
