"""How well points fall into clusters: the silhouette (Rousseeuw 1987) of Ward's clusters.

The best silhouette of any set of points is above 0, and that of a small set is high. So it is
compared with the best silhouette of points without clusters. They are drawn from a normal
distribution of the same covariance (the idea of the gap statistic, Tibshirani and others 2001).

scipy finds the clusters, scikit-learn their silhouettes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from app.numerics.arrays import FloatArray, IntArray

MAX_CLUSTERS = 12
"""The largest number of clusters that is tried."""

DRAWS = 20
"""The number of sets of points without clusters that are drawn."""

SEED = 20090
"""Seed of these draws."""


@dataclass(frozen=True, slots=True)
class Clusters:
    """The 2 to MAX_CLUSTERS clusters that have the best silhouette.

    silhouette: their mean silhouette, -1..1. labels: (n,) the number of each point's cluster.
    """

    silhouette: float
    labels: IntArray

    @property
    def count(self) -> int:
        """The number of clusters."""
        return len(np.unique(self.labels))


@dataclass(frozen=True, slots=True)
class Clusteredness:
    """How well points fall into clusters, compared with points without clusters.

    clusters: the best clusters. unclustered: the mean, over DRAWS sets of as many points without
    clusters, of the best silhouette.
    """

    clusters: Clusters
    unclustered: float

    @property
    def gap(self) -> float:
        """The silhouette minus that of points without clusters."""
        return self.clusters.silhouette - self.unclustered


def clusteredness(points: FloatArray) -> Clusteredness | None:
    """Compare the best clusters of `points` (n, d) with those of points without clusters.

    Returns None for fewer than three points, or if all points are equal. The result is
    deterministic, because the draws have a fixed seed.
    """
    best = best_clusters(points)
    if best is None:
        return None
    rows = np.asarray(points, dtype=np.float64)
    draw = np.random.RandomState(SEED)
    # Normal numbers along the principal axes, scaled, have the covariance of the points.
    _, spreads, axes = np.linalg.svd(rows - rows.mean(axis=0), full_matrices=False)
    drawn = (draw.standard_normal((len(rows), len(axes))) * spreads @ axes for _ in range(DRAWS))
    chance = [one.silhouette for one in map(best_clusters, drawn) if one is not None]
    return Clusteredness(best, float(np.mean(chance)))


def best_clusters(points: FloatArray) -> Clusters | None:
    """Ward's clusters of `points` (n, d), cut where the mean silhouette is largest.

    Of equally good cuts the one with fewer clusters is taken. Returns None for fewer than three
    points, or if all points are equal.
    """
    from sklearn.metrics import silhouette_score  # slow to load

    rows = np.asarray(points, dtype=np.float64)
    if len(rows) < 3 or not np.ptp(rows, axis=0).any():
        return None
    tree, distances = (
        scipy.cluster.hierarchy.linkage(rows, "ward"),
        scipy.spatial.distance.squareform(scipy.spatial.distance.pdist(rows)),
    )
    cuts = []
    for count in range(2, min(MAX_CLUSTERS, len(rows) - 1) + 1):
        labels = scipy.cluster.hierarchy.fcluster(tree, count, "maxclust")
        if len(np.unique(labels)) > 1:  # equal points can prevent a cut into `count` clusters
            score = silhouette_score(distances, labels, metric="precomputed")
            cuts.append(Clusters(float(score), labels))
    return max(cuts, key=lambda one: (one.silhouette, -one.count), default=None)
