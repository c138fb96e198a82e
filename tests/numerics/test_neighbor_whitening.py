"""Whitening against the metric computed pair by pair, and what it does to kinds with a style."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from app.numerics.arrays import FloatArray
from app.numerics.euclidean import distances
from app.numerics.neighbor_whitening import RIDGE, whitened


def naive_metric(points: FloatArray, neighbors: int) -> FloatArray:
    """The slow twin: (d, d) the inverse of the scatter of all neighbors but the first point's."""
    scatter = np.zeros((points.shape[1], points.shape[1]))
    for i in range(1, len(points)):
        others = [j for j in range(1, len(points)) if j != i]
        others.sort(key=lambda j, i=i: float(np.linalg.norm(points[i] - points[j])))
        for j in others[:neighbors]:
            scatter += np.outer(points[i] - points[j], points[i] - points[j])
    mean_variance = np.trace(scatter) / len(scatter)
    return np.linalg.inv(scatter / mean_variance + RIDGE * np.eye(len(scatter)))


@given(n=st.integers(3, 12), neighbors=st.integers(1, 4), seed=st.integers(0, 999))
@settings(max_examples=40, deadline=None)
def test_distances_are_those_of_the_naive_metric_up_to_one_factor(
    n: int, neighbors: int, seed: int
) -> None:
    points = np.random.default_rng(seed).normal(size=(n, 5))
    found = whitened(points, distances(points, points), neighbors)
    metric = naive_metric(points, min(neighbors, n - 2))
    ratios = [
        np.linalg.norm(found[i] - found[j])
        / np.sqrt((points[i] - points[j]) @ metric @ (points[i] - points[j]))
        for i in range(n)
        for j in range(i)
    ]
    np.testing.assert_allclose(ratios, ratios[0], rtol=1e-6)


def test_the_root_mean_square_distance_stays() -> None:
    points = np.random.default_rng(0).normal(size=(20, 4)) * [5, 1, 1, 0.1]
    between = distances(points, points)
    found = whitened(points, between, 3)
    np.testing.assert_allclose(
        np.square(distances(found, found)).mean(), np.square(between).mean(), rtol=1e-6
    )


def test_few_or_equal_points_stay_as_they_are() -> None:
    for points in (np.ones((1, 3)), np.eye(3)[:2], np.ones((5, 3))):
        np.testing.assert_array_equal(whitened(points, distances(points, points), 3), points)


def test_a_style_that_all_kinds_share_counts_less() -> None:
    """Eight kinds; their members differ along one direction. The nearest are of the own kind."""
    rng = np.random.default_rng(3)
    kinds = np.repeat(np.arange(8), 20)
    points = 3.0 * np.eye(8)[kinds] + 0.5 * rng.normal(size=(160, 8))
    style = np.ones(8) / np.sqrt(8)
    points += 4.0 * rng.normal(size=(160, 1)) * style

    def precision(those: FloatArray) -> float:
        between = distances(those, those)
        np.fill_diagonal(between, np.inf)
        nearest = np.argsort(between, axis=1)[:, :10]
        return float((kinds[nearest] == kinds[:, None]).mean())

    assert precision(whitened(points, distances(points, points), 12)) > precision(points) + 0.05
