"""The rising curve is the nearest of all to the points."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from app.numerics.isotonic import rising_means


def naive_levels(y: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """max over a <= i of min over b >= i of the mean of y[a..b] (Robertson 1988, theorem 1.4.4)."""

    def mean(a: int, b: int) -> float:
        return float(np.average(y[a : b + 1], weights=weights[a : b + 1]))

    count = len(y)
    return np.array(
        [max(min(mean(a, b) for b in range(i, count)) for a in range(i + 1)) for i in range(count)]
    )


@settings(deadline=None)
@given(st.lists(st.tuples(st.integers(-9, 9), st.integers(0, 3)), min_size=1, max_size=30))
def test_pools_are_those_of_the_definition(points: list[tuple[int, int]]) -> None:
    x, y = np.array(points, dtype=np.float64).T
    centers, levels = rising_means(x, y)
    assert (np.diff(centers) > 0).all()
    assert (np.diff(levels) > -1e-12).all()
    values, member, counts = np.unique(x, return_inverse=True, return_counts=True)
    means = np.bincount(member, weights=y) / counts
    expected = naive_levels(means, counts)
    np.testing.assert_allclose(np.unique(levels.round(9)), np.unique(expected.round(9)), atol=1e-8)
    # a pool lies at the mean x of its own points
    for center, level in zip(centers, levels, strict=True):
        own = np.isclose(expected, level)
        assert values[own].min() <= center <= values[own].max()


def test_points_that_rise_stay_as_they_are() -> None:
    centers, levels = rising_means(np.array([3.0, 1.0, 2.0]), np.array([0.9, 0.1, 0.5]))
    np.testing.assert_array_equal(centers, [1.0, 2.0, 3.0])
    np.testing.assert_array_equal(levels, [0.1, 0.5, 0.9])


def test_points_that_fall_are_one_pool() -> None:
    centers, levels = rising_means(np.array([1.0, 2.0, 2.0]), np.array([1.0, 0.0, 0.5]))
    np.testing.assert_allclose(centers, [5 / 3])
    np.testing.assert_allclose(levels, [0.5])
