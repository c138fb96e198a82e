"""Diffusion over a neighborhood graph: near is what is reached through what lies between.

Points of one kind often lie along a bend, so that two of them are farther apart than either
is from a point of another kind; a walk from neighbor to neighbor follows the bend (Zhou et
al. 2004, "Ranking on data manifolds", eq. 4; Donoser and Bischof 2013). Edges are weighed by
each point's own distance to its neighbors (Zelnik-Manor and Perona 2004, section 3), so that
dense and sparse places count alike. Everything is continuous in the distances: a point that
moves a little changes its closeness a little, although neighborhoods have ends.
"""

from __future__ import annotations

import numpy as np

from app.numerics.arrays import FloatArray

DAMPING = 0.8
"""Share of each step that goes on; the rest stays at the start."""

REACH = 2.0
"""An edge ends where its squared length is so many times the product of its ends' radii."""

DEGREE_OFFSET = 0.3
"""Added to the sum of a point's edges: one that is hardly tied to any stays so."""

_SMALLEST = 1e-12


def neighbor_radii(distances: FloatArray, neighbors: int) -> FloatArray:
    """(n,) distance of each point to its `neighbors`-th nearest other; distances: (n, n)."""
    count = min(neighbors, len(distances) - 1)
    return np.asarray(np.partition(distances, count, axis=1)[:, count])


def diffused_closeness(
    distances: FloatArray, radii: FloatArray, damping: float = DAMPING
) -> FloatArray:
    """(n,) how closely the first point is tied to each, 0..1; 1 to itself, 0 where no path is.

    distances: (n, n) symmetric, zeros on the diagonal; radii: (n,), as from
    `neighbor_radii`. K = (I - damping D^-1/2 W D^-1/2)^-1 is positive definite, so a kernel;
    given is its cosine K_0i / sqrt(K_00 K_ii), which a point gains nothing in by being a hub.
    """
    weights = _edges(distances, radii)
    degrees = np.sqrt(weights.sum(axis=1) + DEGREE_OFFSET)
    weights *= -damping / degrees
    weights /= degrees[:, None]
    np.fill_diagonal(weights, 1.0)
    # Not by SciPy, which has a triangular inverse: importing it costs a command more than the
    # whole search, and the inverse of some hundred rows takes a millisecond.
    kernel = np.linalg.inv(weights)
    first, own = kernel[0], np.diagonal(kernel)
    return np.asarray(np.clip(first / np.sqrt(own[0] * own), 0.0, 1.0))


def _edges(distances: FloatArray, radii: FloatArray) -> FloatArray:
    """(n, n) Gaussian weights, lowered so that they are 0 from REACH on."""
    scales = np.maximum(np.outer(radii, radii), _SMALLEST)
    weights = np.maximum(np.exp(-np.square(distances) / scales) - np.exp(-REACH), 0.0)
    np.fill_diagonal(weights, 0.0)
    return np.asarray(weights)
