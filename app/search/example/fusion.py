"""The distance of the method `fused`: of vectors, of warping, and along a graph of clips.

Within a shortlist, a clip is also near if a path of short steps leads to it from the query, over
other clips. Such paths join the takes of one task by people of many manners, although a clip of
another task by the same person may be nearer. The graph is built for each query, from the clips
that pass its filter. Nothing is fitted, so a clip is part of it as soon as it is ready.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.numerics.arrays import FloatArray, IntArray
from app.numerics.diffusion import diffused_closeness, neighbor_radii
from app.numerics.euclidean import distances

SHORTLIST = 300
"""Number of clips in the graph; its cost grows with the cube of it, and is 12 ms."""

DTW_WEIGHT = 0.25
"""Weight of the DTW distance, where that of the vectors weighs 1."""

NEIGHBORS = 0.7
"""A clip has so many neighbors in the graph, times the square root of the number of clips."""

DETOUR = 1.0
"""Weight of a long way along the graph, in units of the distance between neighbors."""

MIN_CLOSENESS = 1e-3
"""Clips that are less close on the graph count as if no path led to them."""

MAX_DETOUR = 5.0
"""The graph adds at most so many times the distance itself. So the same motion keeps distance 0."""


@dataclass(frozen=True, slots=True)
class FusedDistance:
    """The part of the fused distance that needs only vectors, which is cheaper than warping.

    near: (n,) the distances of the vectors to the query; far: (n,) the most that the graph adds.
    """

    near: FloatArray
    far: FloatArray

    @classmethod
    def of(cls, query: FloatArray, vectors: FloatArray) -> FusedDistance:
        """query: (d,) and vectors: (n, d), motion vectors."""
        if not len(vectors):
            return cls(np.zeros(0), np.zeros(0))
        between = _distances(np.vstack([query, vectors]).astype(np.float64))
        radii = neighbor_radii(between, max(1, round(NEIGHBORS * len(between) ** 0.5)))
        closeness = diffused_closeness(between, radii)[1:]
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

    Those from the first point are exact: it is the origin, so that its products are zero.
    """
    centered = points - points[0]
    between = distances(centered, centered)
    return np.asarray(np.maximum(between, between.T))
