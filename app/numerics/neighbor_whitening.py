"""Whitening by the scatter of neighbors: what differs between near points counts less.

Near points are mostly of one kind. So the directions in which neighbors differ say how the members
of a kind vary (in motions: with the style), and not what kind it is. In the metric of the inverse
scatter, these directions are short. This is relevant component analysis (Bar-Hillel et al. 2005,
"Learning a Mahalanobis metric from equivalence constraints", section 3) with neighbors in place of
labels. A ridge keeps the directions in which neighbors hardly differ, and makes the result
meaningful for fewer points than dimensions.
"""

from __future__ import annotations

import numpy as np

from app.numerics.arrays import FloatArray

RIDGE = 1.0
"""Added to the scatter, in units of its mean variance. With .3, rare directions are noise."""


def whitened(points: FloatArray, distances: FloatArray, neighbors: int) -> FloatArray:
    """(n, d) `points` (n, d) in coordinates whose Euclidean distance is that of the metric.

    distances: (n, n) of the points. neighbors: how many of the nearest others of each point are
    its neighbors. The first point is a query: it is mapped, but its own differences do not count.
    The result has the root mean square distance of the points. So both have about the same unit.
    """
    scatter = _scatter(points[1:], distances[1:, 1:], neighbors)
    variance = np.trace(scatter) / len(scatter)
    if variance <= 0.0:  # fewer than two points, or equal ones
        return points
    root = np.linalg.cholesky(scatter / variance + RIDGE * np.eye(len(scatter)))
    # not scipy's solve_triangular: a search by command does not wait for scipy.linalg
    mapped = np.linalg.solve(root, points.T).T
    return np.asarray(mapped * np.sqrt(_spread(points) / _spread(mapped)))


def _scatter(points: FloatArray, distances: FloatArray, neighbors: int) -> FloatArray:
    """(d, d) the sum of the outer products of the differences of all points and their neighbors."""
    count = min(neighbors, len(points) - 1)
    if count < 1:
        return np.zeros((points.shape[1], points.shape[1]))
    others = distances.copy()
    np.fill_diagonal(others, np.inf)
    nearest = np.argpartition(others, count - 1, axis=1)[:, :count]
    pairs = np.zeros_like(others)
    np.put_along_axis(pairs, nearest, 1.0, axis=1)
    # sum of p_ij (x_i - x_j)(x_i - x_j)^T = X^T (D - P - P^T) X, with D the sums of P + P^T
    pairs += pairs.T
    centered = points - points.mean(axis=0)
    laplacian = np.diag(pairs.sum(axis=1)) - pairs
    return np.asarray(centered.T @ laplacian @ centered)


def _spread(points: FloatArray) -> float:
    return float(np.square(points - points.mean(axis=0)).sum())
