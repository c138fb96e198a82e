"""The distance of the method `fused`: of vectors, of warping, and along a graph of clips.

The distance of the vectors is that of the motions as they are, or at a common pace if they are
nearer there. Motions of different lengths may be nearer by windows of one second. A clip of which
one is a part of the other is nearer, see `containment`. If one clip has the recording of the query,
it speaks for the query, see `same_recording`.

The vectors of a shortlist are whitened by the scatter of neighbors: a style counts less in the
distance, since near clips differ in it (`app.numerics.neighbor_whitening`).

Within a shortlist, a clip is also near if a path of short steps leads from the query through other
clips to it. Paths connect the takes of one task by different persons, although a clip of another
task by the same person may be nearer. The graph is built for each query, from the clips that pass
its filter. It needs no fit, so a clip is part of it as soon as the clip is ready.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from app.numerics.arrays import FloatArray, IntArray
from app.numerics.diffusion import diffused_closeness, neighbor_radii
from app.numerics.euclidean import distances
from app.numerics.neighbor_whitening import whitened

SHORTLIST = 300
"""Number of clips in the graph. The time grows with the cube of this number, and is 12 ms."""

DTW_WEIGHT = 0.75
"""Weight of the DTW distance; the distance of the vectors has weight 1. Of .5, .75 and 1, chosen on
56 clips of three sources, and 32 of them cut and slow: MAP is .766, .762 and .757, and the nearest
other clip of a clip 1.5 times as slow has its task in .906, .938 and .875. With .5, another walk of
the same person came before the same walk from another file, whose skeleton differs."""

NEIGHBORS = 0.7
"""Number of neighbors of a clip in the graph, divided by the square root of the number of clips."""

ALIKE = 1.0
"""Number of nearest clips that count as alike when vectors are whitened, divided by the square root
of the number of clips. On dataset 1 with the query's own style left out, 1-NN and MAP by vectors
and graph are .733, .653 without it, .811, .665 with 5 clips, and .789, .676 with 20; dataset 2
likewise .906, .828, then .889, .820 and .906, .846; clips as stored .939, .770, then .939, .785 and
.939, .790."""

DETOUR = 1.0
"""Weight of the path along the graph, in units of the distance between neighbors."""

PACED_WEIGHT = 1.25
"""Weight of the distance of the vectors at a common pace. It is above 1, because tempo says
something: of two clips that are equally near at a common pace, the one at the query's tempo comes
first. Of 1.1, 1.25 and 1.4 all do well; chosen on 70 clips of three sources."""

WINDOW_WEIGHT = 1.0
"""Weight of the distance of the windows. Of .8, 1 and 1.2, chosen on the same 32 cut clips: by .8
and 1 the nearest other clip of the middle half has its task in .938 (without windows .875), by 1.2
in .906. Clips as stored do not notice."""

CONTAINED = 0.2
"""Distances of containment from this one on mean nothing. Below it, the fused distance falls in
proportion. Of .15 to .3, the originals of 152 clips as stored, slow and cut are found alike; with
.15, the other clips of a cut one come later. A limit that grows with the query's
distance to its neighbors was tried: it costs .003 of P@20 and of MAP on clips as stored."""

LEAST_SHARE = 0.05
"""Containment makes a distance smaller by this factor at most. So only an equal motion has
distance 0, and a motion of which the query is a part follows it."""

MIN_CLOSENESS = 1e-3
"""Smallest closeness on the graph. Less close clips count as clips without a path."""

MAX_DETOUR = 5.0
"""The graph adds at most this multiple of the distance. So an equal motion has distance 0."""


@dataclass(frozen=True, slots=True)
class Neighborhood:
    """A query and n clips, and how far each is from each other. The query is point 0.

    between: (n + 1, n + 1) distances of the whitened vectors; detours: (n + 1, n + 1) the largest
    number that the graph adds to each distance.
    """

    between: FloatArray
    detours: FloatArray

    @classmethod
    def of(cls, query: FloatArray, vectors: FloatArray) -> Neighborhood:
        """The motion vectors (d,) of a query and (n, d) of clips."""
        points = np.vstack([query, vectors]).astype(np.float64)
        alike = round(ALIKE * len(points) ** 0.5)
        between = _distances(whitened(points, _distances(points), alike))
        radii = neighbor_radii(between, max(1, round(NEIGHBORS * len(between) ** 0.5)))
        closeness = diffused_closeness(between, radii)
        # The logarithm makes the closeness, 1..0, a length: 0 for itself, larger for far points.
        far = -np.log((closeness + MIN_CLOSENESS) / (1.0 + MIN_CLOSENESS))
        return cls(between, float(np.median(radii)) * far)

    def seen_from(self, point: int) -> FusedDistance:
        """The fused distances of the n clips to a point: to the query, or to a clip."""
        near = self.between[point, 1:]
        return FusedDistance(near, self.detours[point, 1:], np.ones(len(near)))


@dataclass(frozen=True, slots=True)
class FusedDistance:
    """The part of the fused distance that needs only vectors, which is cheaper than warping.

    near: (n,) the distances of the vectors to the query; far: (n,) the largest number that the
    graph adds to each distance; shares: (n,) above 0, at most 1: factors of the whole distance.
    """

    near: FloatArray
    far: FloatArray
    shares: FloatArray

    def nearer(self, paced: FloatArray, windows: FloatArray) -> FusedDistance:
        """The same distances, but small also for clips of another tempo or length.

        paced: (n,) distances of the vectors at a common pace. windows: (n,) distances of windows.
        Each is infinity if unknown.
        """
        other = np.minimum(PACED_WEIGHT * paced, WINDOW_WEIGHT * windows)
        return replace(self, near=np.minimum(self.near, other))

    def contained(self, distances: FloatArray) -> FusedDistance:
        """The same distances, but small for clips of which one is a part of the other.

        distances: (n,) of containment, infinity if unknown.
        """
        return replace(self, shares=np.clip(distances / CONTAINED, LEAST_SHARE, 1.0))

    def distances(self, rows: IntArray, warped: FloatArray) -> FloatArray:
        """(m,) fused distances of `rows` (m,); warped: (m,) their DTW distances to the query.

        A fused distance never falls when a DTW distance rises. So with 0 for all DTW distances,
        the results are lower bounds.
        """
        straight = self.near[rows] + DTW_WEIGHT * warped
        detour = DETOUR * np.minimum(self.far[rows], MAX_DETOUR * straight)
        return np.asarray(self.shares[rows] * (straight + detour))


def _distances(points: FloatArray) -> FloatArray:
    """(n, n) symmetric Euclidean distances of `points` (n, d).

    The distances from the first point are exact: it is the origin, so its products are zero.
    """
    centered = points - points[0]
    between = distances(centered, centered)
    return np.asarray(np.maximum(between, between.T))
