"""Diffusion over a neighborhood graph: how closely points are connected through other points.

Points of one kind often lie along a curve. Then two of them can be farther apart than either is
from a point of another kind. A random walk from neighbor to neighbor follows the curve (Zhou et
al. 2004, "Ranking on data manifolds", eq. 4; Donoser and Bischof 2013). The weight of an edge
depends on the distances of its two ends to their own neighbors (Zelnik-Manor and Perona 2004,
section 3), so that dense and sparse regions count alike. The result is continuous in the
distances: if a point moves a little, its closeness changes a little.
"""

from __future__ import annotations

import numpy as np

from app.numerics.arrays import FloatArray

DAMPING = 0.8
"""The share of a walk that goes on at each step. The other share returns to the start."""

REACH = 2.0
"""Two points have no edge if their squared distance exceeds this multiple of the product of
their radii."""

DEGREE_OFFSET = 0.3
"""Added to the sum of a point's edge weights. It keeps a point with weak edges weakly connected."""

_MIN_SCALE = 1e-12
"""Avoids a division by 0 if the radii of two points are 0."""


def neighbor_radii(distances: FloatArray, neighbors: int) -> FloatArray:
    """(n,) the distance of each point to its `neighbors`-th nearest other point.

    distances: (n, n) symmetric, zeros on the diagonal. With fewer other points, the farthest
    one is taken. The unit is that of `distances`.
    """
    count = min(neighbors, len(distances) - 1)
    return np.asarray(np.partition(distances, count, axis=1)[:, count])


def diffused_closeness(
    distances: FloatArray, radii: FloatArray, damping: float = DAMPING
) -> FloatArray:
    """(n, n) the closeness of each point to each other point, 0..1.

    A point has closeness 1 to itself. Points that no path connects have closeness 0.
    distances: (n, n) symmetric, zeros on the diagonal. radii: (n,) in the same unit, as from
    `neighbor_radii`. damping: 0 to less than 1, the share of a walk that goes on at each step.

    K = (I - damping D^-1/2 W D^-1/2)^-1 is positive definite, so it is a kernel. The result is
    its cosine K_ij / sqrt(K_ii K_jj). The cosine gives no advantage to points with many edges.
    """
    weights = _edges(distances, radii)
    degrees = np.sqrt(weights.sum(axis=1) + DEGREE_OFFSET)
    weights *= -damping / degrees
    weights /= degrees[:, None]
    np.fill_diagonal(weights, 1.0)
    # SciPy has an inverse for symmetric matrices, but importing it takes a command longer than
    # the whole search, and this inverse of a few hundred rows takes a millisecond.
    kernel = np.linalg.inv(weights)
    own = np.sqrt(np.diagonal(kernel))
    return np.asarray(np.clip(kernel / own / own[:, None], 0.0, 1.0))


def _edges(distances: FloatArray, radii: FloatArray) -> FloatArray:
    """(n, n) Gaussian edge weights, lowered by a constant so that they reach 0 at REACH."""
    scales = np.maximum(np.outer(radii, radii), _MIN_SCALE)
    weights = np.maximum(np.exp(-np.square(distances) / scales) - np.exp(-REACH), 0.0)
    np.fill_diagonal(weights, 0.0)
    return np.asarray(weights)
