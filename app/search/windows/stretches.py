"""Stretches: a curve of probabilities cut where what is probable changes.

Neighboring points are merged, the most similar first, as Ward's method does, until the next merge
would cost too much.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from app.numerics.arrays import FloatArray

MAX_COST = 2.0
"""The largest growth of the sum of squares by one merge: a word that is sure on one side and
absent on the other, for 1 s (4 steps) each, costs 2."""


def even_stretches(curve: FloatArray, max_cost: float = MAX_COST) -> list[tuple[int, int]]:
    """The stretches of `curve` (n, V): first point, and the point after the last, in order."""
    bounds = list(range(len(curve) + 1))
    means = [row.astype(np.float64) for row in curve]
    costs = [_cost(means, bounds, at) for at in range(len(means) - 1)]
    while costs:
        at = int(np.argmin(costs))
        if costs[at] > max_cost:
            break
        first, second = bounds[at + 1] - bounds[at], bounds[at + 2] - bounds[at + 1]
        mean = (first * means[at] + second * means[at + 1]) / (first + second)
        means[at : at + 2] = [mean]
        del bounds[at + 1], costs[at]
        for near in (at - 1, at):
            if 0 <= near < len(costs):
                costs[near] = _cost(means, bounds, near)
    return list(pairwise(bounds))


def _cost(means: list[FloatArray], bounds: list[int], at: int) -> float:
    """By how much the sum of squares grows if the stretches `at` and `at` + 1 are merged."""
    first, second = bounds[at + 1] - bounds[at], bounds[at + 2] - bounds[at + 1]
    apart = means[at] - means[at + 1]
    return float(apart @ apart) * first * second / (first + second)
