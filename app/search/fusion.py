"""The distance of `fused`: vectors and warping, and what lies between (DESIGN 7).

Within a shortlist, a clip is also near when one gets to it from the query by way of others,
each near the last: takes of one task by people of many manners are joined so, although a
clip of another task by the same person may be nearer. The graph is made anew for each
question, of the clips that pass its filter and nothing else; nothing is fitted, and a clip
that became ready a moment ago is in it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.numerics.arrays import FloatArray, IntArray
from app.numerics.diffusion import diffused_closeness, neighbour_radii
from app.numerics.euclidean import distances

SHORTLIST = 300
"""Clips that are compared so; the graph costs the cube of it, 12 ms."""

DTW_WEIGHT = 0.25
"""Weight of the DTW distance beside the vector's."""

NEIGHBOURS = 0.7
"""A clip's neighbours in the graph, as a share of the square root of the number of clips."""

DETOUR = 1.0
"""Weight of being far on the graph, in units of the distance between neighbours."""

LEAST_CLOSENESS = 1e-3
"""What is less close on the graph is as far as if there were no way."""

MOST_DETOUR = 5.0
"""The graph adds at most so many times the distance itself: the same motion stays at 0."""


@dataclass(frozen=True, slots=True)
class Surroundings:
    """What vectors tell of a shortlist before anything is warped, which is dearer.

    near: (n,) distances of the vectors; far: (n,) what the graph adds, at most.
    """

    near: FloatArray
    far: FloatArray

    @classmethod
    def of(cls, query: FloatArray, vectors: FloatArray) -> Surroundings:
        """query: (d,) and vectors: (n, d), motion vectors."""
        if not len(vectors):
            return cls(np.zeros(0), np.zeros(0))
        between = _distances(np.vstack([query, vectors]).astype(np.float64))
        radii = neighbour_radii(between, max(1, round(NEIGHBOURS * len(between) ** 0.5)))
        closeness = diffused_closeness(between, radii)[1:]
        far = -np.log((closeness + LEAST_CLOSENESS) / (1.0 + LEAST_CLOSENESS))
        return cls(between[0, 1:], float(np.median(radii)) * far)

    def distances(self, rows: IntArray, warped: FloatArray) -> FloatArray:
        """(m,) fused distances of `rows` (m,), given their DTW distances to the query (m,).

        They never fall as those rise, so that with 0 for all of them they are lower bounds.
        """
        straight = self.near[rows] + DTW_WEIGHT * warped
        return np.asarray(straight + DETOUR * np.minimum(self.far[rows], MOST_DETOUR * straight))


def _distances(points: FloatArray) -> FloatArray:
    """(n, n) symmetric Euclidean distances of `points` (n, d).

    Those from the first point are exact: it is the origin, so that its products are zero.
    """
    centred = points - points[0]
    between = distances(centred, centred)
    return np.asarray(np.maximum(between, between.T))
