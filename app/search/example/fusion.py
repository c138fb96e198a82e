"""The distance of the method `fused`: of vectors, of warping, and along a graph of clips.

Within a shortlist, a clip is also near if a path of short steps leads from the query through other
clips to it. Paths connect the takes of one task by different persons, although a clip of another
task by the same person may be nearer. The graph is built for each query, from the clips that pass
its filter. It needs no fit, so a clip is part of it as soon as the clip is ready.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.numerics.arrays import FloatArray, IntArray
from app.numerics.diffusion import diffused_closeness, neighbor_radii
from app.numerics.euclidean import distances

SHORTLIST = 300
"""Number of clips in the graph. The time grows with the cube of this number, and is 12 ms."""

DTW_WEIGHT = 0.25
"""Weight of the DTW distance; the distance of the vectors has weight 1."""

NEIGHBORS = 0.7
"""Number of neighbors of a clip in the graph, divided by the square root of the number of clips."""

DETOUR = 1.0
"""Weight of the path along the graph, in units of the distance between neighbors."""

MIN_CLOSENESS = 1e-3
"""Smallest closeness on the graph. Less close clips count as clips without a path."""

MAX_DETOUR = 5.0
"""The graph adds at most this multiple of the distance. So an equal motion has distance 0."""


@dataclass(frozen=True, slots=True)
class FusedDistance:
    """The part of the fused distance that needs only vectors, which is cheaper than warping.

    near: (n,) the distances of the vectors to the query; far: (n,) the largest number that the
    graph adds to each distance.
    """

    near: FloatArray
    far: FloatArray

    @classmethod
    def of(cls, query: FloatArray, vectors: FloatArray) -> FusedDistance:
        """The distances of motion vectors (n, d) to a query (d,)."""
        if not len(vectors):  # a graph needs two points
            return cls(np.zeros(0), np.zeros(0))
        between = _distances(np.vstack([query, vectors]).astype(np.float64))
        radii = neighbor_radii(between, max(1, round(NEIGHBORS * len(between) ** 0.5)))
        closeness = diffused_closeness(between, radii)[1:]
        # The logarithm makes the closeness, 1..0, a length: 0 for the query, larger for far clips.
        far = -np.log((closeness + MIN_CLOSENESS) / (1.0 + MIN_CLOSENESS))
        return cls(between[0, 1:], float(np.median(radii)) * far)

    def distances(self, rows: IntArray, warped: FloatArray) -> FloatArray:
        """(m,) fused distances of `rows` (m,); warped: (m,) their DTW distances to the query.

        A fused distance never falls when a DTW distance rises. So with 0 for all DTW distances,
        the results are lower bounds.
        """
        straight = self.near[rows] + DTW_WEIGHT * warped
        return np.asarray(straight + DETOUR * np.minimum(self.far[rows], MAX_DETOUR * straight))


def _distances(points: FloatArray) -> FloatArray:
    """(n, n) symmetric Euclidean distances of `points` (n, d).

    The distances from the first point are exact: it is the origin, so its products are zero.
    """
    centered = points - points[0]
    between = distances(centered, centered)
    return np.asarray(np.maximum(between, between.T))
