from __future__ import annotations

import numpy as np
import pytest
import scipy
from scipy.spatial.distance import cdist

from app.numerics.mds import classical_mds, metric_mds, place, stress


def distorted(points: np.ndarray, seed: int = 0) -> np.ndarray:
    noise = np.random.default_rng(seed).uniform(0.7, 1.4, (len(points), len(points)))
    distances = cdist(points, points) * (noise + noise.T) / 2
    np.fill_diagonal(distances, 0.0)
    return distances


@pytest.fixture
def points() -> np.ndarray:
    return np.random.default_rng(3).normal(size=(30, 4))


@pytest.mark.parametrize("scale", [classical_mds, metric_mds])
def test_true_distances_come_back(points: np.ndarray, scale) -> None:  # type: ignore[no-untyped-def]
    distances = cdist(points, points)
    found = scale(distances, 4)
    np.testing.assert_allclose(cdist(found, found), distances, atol=1e-6)


def test_refining_lowers_the_error_of_the_paper(points: np.ndarray) -> None:
    distances = distorted(points)
    assert stress(metric_mds(distances, 3), distances) < 0.9 * stress(
        classical_mds(distances, 3), distances
    )


def test_error_is_equation_3(points: np.ndarray) -> None:
    distances = distorted(points)
    found = classical_mds(distances, 2)
    i, j = np.triu_indices(len(points), 1)
    squares, reached = distances[i, j] ** 2, cdist(found, found)[i, j] ** 2
    expected = ((squares - reached) ** 2 / (4 * squares)).sum()
    assert stress(found, distances) == pytest.approx(expected)


def test_error_falls_with_dimensions(points: np.ndarray) -> None:
    distances = distorted(points)
    errors = [stress(metric_mds(distances, d), distances) for d in (1, 2, 3, 4)]
    assert errors == sorted(errors, reverse=True)


def test_new_points_are_placed_where_they_belong(points: np.ndarray) -> None:
    landmarks, others = points[:20], points[20:]
    np.testing.assert_allclose(place(cdist(others, landmarks), landmarks), others, atol=1e-4)


def test_placing_is_no_worse_than_triangulation_under_noise(points: np.ndarray) -> None:
    landmarks = points[:20]
    targets = distorted(points)[20:, :20]
    found = place(targets, landmarks)
    error = ((targets**2 - cdist(found, landmarks) ** 2) ** 2 / (4 * targets**2)).sum()
    true = ((targets**2 - cdist(points[20:], landmarks) ** 2) ** 2 / (4 * targets**2)).sum()
    assert error < true


@pytest.mark.parametrize("count", [1, 2, 3, 5])
def test_few_points_and_all_the_same(count: int) -> None:
    nothing = metric_mds(np.zeros((count, count)), 10)
    assert nothing.shape == (count, 10)
    assert np.isfinite(nothing).all()
    assert np.isfinite(place(np.zeros((2, count)), nothing)).all()
    assert np.isfinite(place(np.ones((2, count)), nothing)).all()
    assert place(np.zeros((0, count)), nothing).shape == (0, 10)


def test_duplicates_keep_together(points: np.ndarray) -> None:
    doubled = np.vstack([points, points[:1]])
    found = metric_mds(cdist(doubled, doubled), 4)
    np.testing.assert_allclose(found[0], found[-1], atol=1e-3)


def test_placing_lowers_the_error_as_step_by_step_derivatives_do() -> None:
    rng = np.random.default_rng(3)
    landmarks, points = rng.normal(size=(12, 3)), rng.normal(size=(7, 3))
    exact = np.linalg.norm(points[:, None] - landmarks, axis=2)
    distances = exact * rng.uniform(0.8, 1.2, size=exact.shape)
    placed = place(distances, landmarks)
    for point, own in zip(placed, distances, strict=True):

        def residuals(x: np.ndarray, own: np.ndarray = own) -> np.ndarray:
            return np.asarray((own**2 - ((x - landmarks) ** 2).sum(axis=1)) / (2.0 * own))

        slow = scipy.optimize.least_squares(residuals, point + 0.01, xtol=1e-12, ftol=1e-12)
        np.testing.assert_allclose(point, slow.x, atol=1e-4)
