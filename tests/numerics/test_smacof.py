"""Majorization finds points for their distances, the same ones each time."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.distance import cdist

from app.numerics.mds import classical_mds
from app.numerics.smacof import smacof


def _distances(seed: int, count: int = 20, noise: float = 0.3) -> np.ndarray:
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(count, 4))
    bent = cdist(points, points) + noise * rng.random((count, count))
    made = (bent + bent.T) / 2
    np.fill_diagonal(made, 0.0)
    return made


def raw_stress(points: np.ndarray, targets: np.ndarray) -> float:
    return float(np.square(cdist(points, points) - targets).sum() / 2)


def test_points_are_recovered_except_for_rotations() -> None:
    points = np.random.default_rng(0).normal(size=(15, 3))
    found = smacof(cdist(points, points), 3)
    assert np.allclose(cdist(found, found), cdist(points, points), atol=1e-4)


@given(st.integers(0, 50), st.integers(1, 3))
@settings(max_examples=15, deadline=None)
def test_stress_is_no_worse_than_that_of_classical_scaling(seed: int, dimensions: int) -> None:
    targets = _distances(seed)
    assert raw_stress(smacof(targets, dimensions), targets) <= raw_stress(
        classical_mds(targets, dimensions), targets
    )


def test_no_small_step_lowers_the_stress() -> None:
    targets, rng = _distances(3), np.random.default_rng(0)
    found = smacof(targets, 2)
    least = raw_stress(found, targets)
    steps = (rng.normal(size=found.shape) for _ in range(30))
    assert min(raw_stress(found + 1e-2 * step, targets) for step in steps) > least


def test_the_same_distances_give_the_same_points() -> None:
    targets = _distances(4)
    np.testing.assert_array_equal(smacof(targets, 3), smacof(targets.copy(), 3))


def test_points_are_turned_as_classical_scaling_turns_them() -> None:
    targets = _distances(5)
    assert (np.sum(smacof(targets, 3) * classical_mds(targets, 3), axis=0) > 0).all()


def test_few_points_and_equal_points_give_finite_results() -> None:
    assert smacof(np.zeros((1, 1)), 2).shape == (1, 2)
    assert np.isfinite(smacof(np.zeros((4, 4)), 2)).all()
