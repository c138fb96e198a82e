"""Clusteredness: clusters are told from their absence."""

from __future__ import annotations

import numpy as np
import pytest

from app.numerics.arrays import FloatArray, IntArray
from app.numerics.clusteredness import best_clusters, clusteredness


def _clusters(count: int, each: int, spread: float, seed: int = 1) -> tuple[FloatArray, IntArray]:
    draw = np.random.default_rng(seed)
    centers = draw.normal(size=(count, 3))
    labels = np.repeat(np.arange(count), each)
    return centers[labels] + spread * draw.normal(size=(count * each, 3)), labels


def _slow_silhouette(points: FloatArray, labels: IntArray) -> float:
    """Point by point, as Rousseeuw wrote it."""
    scores = []
    for i, point in enumerate(points):

        def mean_distance(label: int, without: int = i, here: FloatArray = point) -> float:
            others = [j for j in range(len(points)) if labels[j] == label and j != without]
            return float(np.mean([np.linalg.norm(points[j] - here) for j in others]))

        if (labels == labels[i]).sum() == 1:
            scores.append(0.0)
            continue
        a = mean_distance(labels[i])
        b = min(mean_distance(label) for label in set(labels) - {labels[i]})
        scores.append((b - a) / max(a, b))
    return float(np.mean(scores))


@pytest.mark.parametrize("seed", range(3))
def test_the_silhouette_is_rousseeuw_s(seed: int) -> None:
    points, _ = _clusters(4, 5, 0.4, seed)
    points[0] += 9  # alone in its cluster
    found = best_clusters(points)
    assert found is not None
    assert found.silhouette == pytest.approx(_slow_silhouette(points, found.labels))


def test_clusters_are_counted_and_exceed_chance() -> None:
    points, _ = _clusters(5, 6, 0.03)
    found = clusteredness(points)
    assert found is not None
    assert found.clusters.count == 5
    assert found.clusters.silhouette > 0.8
    assert found.gap > 0.3


def test_points_without_clusters_have_no_gap() -> None:
    cloud = np.random.default_rng(3).normal(size=(60, 3)) * [3.0, 1.0, 0.5]
    found = clusteredness(cloud)
    assert found is not None
    assert abs(found.gap) < 0.06
    again = clusteredness(cloud)
    assert again is not None
    assert again.gap == found.gap, "draws are seeded"


@pytest.mark.parametrize("points", [np.zeros((0, 3)), np.zeros((2, 3)), np.ones((9, 3))])
def test_too_few_points_have_no_result(points: FloatArray) -> None:
    assert clusteredness(points) is None


def test_repeated_points_are_clusters_of_size_zero() -> None:
    found = clusteredness(np.repeat(np.eye(3), 4, axis=0))
    assert found is not None
    assert (found.clusters.silhouette, found.clusters.count) == (1.0, 3)
