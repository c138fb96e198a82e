"""Diffusion over a neighborhood graph: against its slow twin, and what it is for."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.numerics.arrays import FloatArray
from app.numerics.diffusion import DAMPING, DEGREE_OFFSET, REACH, diffused_closeness, neighbor_radii


def between(points: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.norm(points[:, None] - points[None], axis=2))


def naive_closeness(distances: FloatArray, radii: FloatArray) -> FloatArray:
    """Walks of every length added up, one step after the other."""
    n = len(distances)
    weights = np.zeros((n, n))
    for i in range(n):
        for j in range(n):
            if i != j:
                edge = np.exp(-(distances[i, j] ** 2) / max(radii[i] * radii[j], 1e-12))
                weights[i, j] = max(edge - np.exp(-REACH), 0.0)
    degrees = weights.sum(axis=1) + DEGREE_OFFSET
    step = DAMPING * weights / np.sqrt(degrees[:, None] * degrees[None])
    walks, power = np.eye(n), np.eye(n)
    for _ in range(300):
        power = power @ step
        walks += power
    own = np.diag(walks)
    return np.asarray(walks / np.sqrt(own[:, None] * own))


@given(n=st.integers(2, 25), k=st.integers(1, 30), seed=st.integers(0, 10_000))
@settings(max_examples=40, deadline=None)
def test_closeness_is_the_sum_over_all_walks(n: int, k: int, seed: int) -> None:
    distances = between(np.random.default_rng(seed).normal(size=(n, 3)))
    radii = neighbor_radii(distances, k)
    for row, radius in enumerate(radii):
        assert radius == np.sort(distances[row])[min(k, n - 1)]
    found = diffused_closeness(distances, radii)
    np.testing.assert_allclose(found, naive_closeness(distances, radii), atol=1e-9)
    assert np.diag(found) == pytest.approx(1.0)
    assert ((found >= 0) & (found <= 1)).all()


def test_a_point_at_the_end_of_small_steps_is_closer_than_one_beyond_a_gap() -> None:
    """Two half moons, the classic: the own far end against the other's near one."""
    angles = np.linspace(0, np.pi, 40)
    own = np.column_stack([np.cos(angles), np.sin(angles)])
    other = np.column_stack([1 - np.cos(angles), 0.4 - np.sin(angles)])
    distances = between(np.vstack([own, other]))
    assert distances[0, 40:].min() < distances[0, 39]
    found = diffused_closeness(distances, neighbor_radii(distances, 5))[0]
    assert found[1:40].min() > found[40:].max()


def test_a_small_move_changes_little() -> None:
    rng = np.random.default_rng(4)
    points = rng.normal(size=(60, 4))
    worst = 0.0
    for _ in range(30):
        moved = points.copy()
        moved[0] += 1e-6 * rng.normal(size=4)
        one, other = (
            diffused_closeness(d, neighbor_radii(d, 5)) for d in (between(points), between(moved))
        )
        worst = max(worst, float(np.abs(one - other).max()))
    assert worst < 1e-4


def test_equal_points_and_two_points_give_finite_results() -> None:
    same = np.zeros((4, 4))
    found = diffused_closeness(same, neighbor_radii(same, 2))[0]
    assert np.isfinite(found).all()
    assert np.ptp(found[1:]) == pytest.approx(0.0)
    two = np.array([[0.0, 3.0], [3.0, 0.0]])
    assert 0.0 < diffused_closeness(two, neighbor_radii(two, 1))[0, 1] < 1.0
