"""Isotonic regression: the rising curve nearest to points, by pooling neighbours that fall."""

from __future__ import annotations

import numpy as np

from app.numerics.arrays import FloatArray


def rising_means(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Mean x and mean y (k,) of the pools of points (n,), n >= 1, both strictly rising.

    Pool adjacent violators; between pools one interpolates.
    """
    order = np.argsort(x, kind="stable")
    values, first = np.unique(x[order], return_index=True)
    weights = np.diff(np.append(first, len(x))).astype(np.float64)
    sums = np.add.reduceat(np.asarray(y, dtype=np.float64)[order], first)
    pools: list[tuple[float, float, float]] = []  # weight, sum of x, sum of y
    for pool in zip(weights.tolist(), (values * weights).tolist(), sums.tolist(), strict=True):
        weight, x_sum, y_sum = pool
        # as fractions multiplied out, so that no rounding parts equal means
        while pools and pools[-1][2] * weight >= y_sum * pools[-1][0]:
            before = pools.pop()
            weight, x_sum, y_sum = weight + before[0], x_sum + before[1], y_sum + before[2]
        pools.append((weight, x_sum, y_sum))
    table = np.array(pools)
    return table[:, 1] / table[:, 0], table[:, 2] / table[:, 0]
