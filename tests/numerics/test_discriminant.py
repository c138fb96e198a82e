from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sklearn.discriminant_analysis import LinearDiscriminantAnalysis

from app.numerics.discriminant import discriminants


def classes_of(sizes: list[int], width: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    labels = rng.permutation(np.repeat(np.arange(len(sizes)), sizes))
    means = 2 * rng.normal(size=(len(sizes), width))
    mixing = rng.normal(size=(width, width))
    return means[labels] + rng.normal(size=(len(labels), width)) @ mixing, labels


def scatters(points: np.ndarray, labels: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Within and between classes: the slow, obvious twins, by their definitions."""
    width = points.shape[1]
    within, between = np.zeros((width, width)), np.zeros((width, width))
    for label in np.unique(labels):
        rows = points[labels == label]
        apart = rows.mean(axis=0) - points.mean(axis=0)
        between += len(rows) * np.outer(apart, apart) / len(points)
        for row in rows - rows.mean(axis=0):
            within += np.outer(row, row)
    return within / max(len(points) - len(np.unique(labels)), 1), between


def test_the_fewer_the_examples_the_more_their_scatter_is_shrunk() -> None:
    rng = np.random.default_rng(0)
    spread = np.linspace(0.5, 3, 12)
    shares = []
    for each in (2, 4, 16, 256):
        labels = np.repeat(np.arange(6), each)
        points = 5 * rng.normal(size=(6, 12))[labels] + rng.normal(size=(len(labels), 12)) * spread
        shares.append(discriminants(points, labels, 1).shrinkage)
    assert shares == sorted(shares, reverse=True)
    assert shares[0] > 0.2
    assert shares[-1] < 0.02


@pytest.mark.parametrize("sizes", [[1, 1, 1], [3, 3]])
def test_constant_points_give_a_sphere(sizes: list[int]) -> None:
    labels = np.repeat(np.arange(len(sizes)), sizes)
    assert discriminants(np.eye(3)[labels % 3], labels, 3).shrinkage == 1.0


@pytest.mark.parametrize("sizes", [[20, 30, 10, 15], [9, 4, 6]])
def test_without_shrinkage_axes_are_those_of_scikit_learn(sizes: list[int]) -> None:
    points, labels = classes_of(sizes, 6)
    found = discriminants(points, labels, len(sizes) - 1, shrinkage=0.0)
    twin = LinearDiscriminantAnalysis(solver="eigen").fit(points, labels)
    theirs = twin.scalings_[:, : len(sizes) - 1]
    for ours, other in zip(found.axes.T, theirs.T, strict=True):
        cosine = ours @ other / np.linalg.norm(ours) / np.linalg.norm(other)
        assert abs(cosine) == pytest.approx(1, abs=1e-4)
    shares = found.between / found.between.sum()
    np.testing.assert_allclose(shares, twin.explained_variance_ratio_, atol=1e-4)


@given(st.integers(0, 10_000), st.integers(2, 5), st.integers(2, 6))
def test_coordinates_have_unit_variance_within_classes_and_between_as_reported(
    seed: int, classes: int, width: int
) -> None:
    points, labels = classes_of([6] * classes, width, seed)
    found = discriminants(points, labels, width)
    assert found.axes.shape == (width, width)
    seen = points @ found.axes
    within, _ = scatters(points, labels)
    sphere = np.trace(within) / width * np.eye(width)
    shrunk = (1 - found.shrinkage) * within + max(found.shrinkage, 1e-6) * sphere
    np.testing.assert_allclose(found.axes.T @ shrunk @ found.axes, np.eye(width), atol=1e-6)
    _, between = scatters(seen, labels)
    np.testing.assert_allclose(between, np.diag(found.between), atol=1e-6)
    assert np.all(np.diff(found.between) <= 1e-9)


def test_axes_after_the_separating_ones_are_sorted_by_variance() -> None:
    rng = np.random.default_rng(0)
    labels = np.repeat([0, 1], 500)
    points = rng.normal(size=(1000, 4)) * [1, 3, 0.5, 2]
    points[:, 0] += 10 * labels
    found = discriminants(points, labels, 4)
    leading = np.argmax(np.abs(found.axes) * [1, 3, 0.5, 2], axis=0)
    assert leading.tolist() == [0, 1, 3, 2]


@pytest.mark.parametrize("points", [np.zeros((4, 3)), np.ones((2, 3)), np.eye(3)[[0, 0, 1, 1]]])
def test_small_classes_and_equal_points_give_finite_axes(points: np.ndarray) -> None:
    found = discriminants(points, np.arange(len(points)) // max(len(points) // 2, 1), 3)
    assert np.isfinite(found.axes).all()
    assert np.isfinite(found.between).all()


def test_axes_do_not_depend_on_the_order_of_the_examples() -> None:
    points, labels = classes_of([5, 6, 7], 4)
    turned = np.random.default_rng(1).permutation(len(labels))
    ours, theirs = (
        discriminants(points, labels, 4),
        discriminants(points[turned], labels[turned], 4),
    )
    np.testing.assert_allclose(ours.axes, theirs.axes, atol=1e-9)
