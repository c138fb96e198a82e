"""Symmetric rank-1 approximation: identities, a general decomposition as the twin."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tensorly.decomposition import parafac

from app.numerics.arrays import FloatArray
from app.numerics.tensors.rank1 import Rank1, symmetric_rank1


def a_volume(seed: int, joints: int = 6, frames: int = 9) -> FloatArray:
    """Symmetric and not negative, as volumes of distances are."""
    drawn = np.random.default_rng(seed).random((joints, joints, frames))
    return drawn + drawn.transpose(1, 0, 2)


def whole(found: Rank1) -> FloatArray:
    return found.weight * np.einsum("i,j,k->ijk", found.primary, found.primary, found.secondary)


def test_a_rank_1_volume_is_found_exactly() -> None:
    rng = np.random.default_rng(0)
    rho, epsilon = rng.random(13), rng.random(40)
    rho, epsilon = rho / np.linalg.norm(rho), epsilon / np.linalg.norm(epsilon)
    found = symmetric_rank1(7.5 * np.einsum("i,j,k->ijk", rho, rho, epsilon))
    assert found.weight == pytest.approx(7.5)
    np.testing.assert_allclose(found.primary, rho, atol=1e-9)
    np.testing.assert_allclose(found.secondary, epsilon, atol=1e-9)
    assert found.errors[-1] < 1e-7
    assert found.converged


@given(seed=st.integers(0, 10_000))
@settings(max_examples=30, deadline=None)
def test_the_residual_is_the_part_that_the_weight_does_not_explain(seed: int) -> None:
    volume = a_volume(seed)
    found = symmetric_rank1(volume)
    left = np.linalg.norm(volume - whole(found)) ** 2
    assert left == pytest.approx(np.linalg.norm(volume) ** 2 - found.weight**2, rel=1e-8)
    assert found.errors[-1] == pytest.approx(np.sqrt(left) / np.linalg.norm(volume), abs=1e-6)
    assert np.linalg.norm(found.primary) == pytest.approx(1.0)
    assert np.linalg.norm(found.secondary) == pytest.approx(1.0)


def algorithm_1(volume: FloatArray, iterations: int) -> list[tuple[float, FloatArray, FloatArray]]:
    """Lambda, rho and epsilon after each iteration of the printed algorithm, number by number."""
    joints, _, frames = volume.shape
    rho, epsilon = np.ones(joints) / joints**0.5, np.ones(frames) / frames**0.5
    told = []
    for _ in range(iterations):
        new_rho, new_epsilon = np.zeros(joints), np.zeros(frames)
        for i, j, k in np.ndindex(*volume.shape):
            new_rho[i] += volume[i, j, k] * rho[j] * epsilon[k]
            new_epsilon[k] += volume[i, j, k] * rho[i] * rho[j]
        rho = new_rho / np.linalg.norm(new_rho)
        epsilon = new_epsilon / np.linalg.norm(new_epsilon)
        weight = sum(
            volume[i, j, k] * rho[i] * rho[j] * epsilon[k] for i, j, k in np.ndindex(*volume.shape)
        )
        told.append((weight, rho, epsilon))
    return told


@pytest.mark.parametrize("seed", range(4))
def test_equals_the_printed_algorithm_step_by_step(seed: int) -> None:
    volume = a_volume(seed, joints=4, frames=5)
    found = symmetric_rank1(volume)
    told = algorithm_1(volume, found.iterations)
    weights = np.array([weight for weight, _, _ in told])
    np.testing.assert_allclose(
        found.changes[1:], np.abs(np.diff(weights)) / weights[1:], atol=1e-13
    )
    share = weights / np.linalg.norm(volume)
    np.testing.assert_allclose(found.errors, np.sqrt(1 - share**2), atol=1e-9)
    np.testing.assert_allclose(found.primary, told[-1][1], atol=1e-12)
    np.testing.assert_allclose(found.secondary, told[-1][2], atol=1e-6)


@pytest.mark.parametrize("seed", range(5))
def test_equals_a_general_decomposition(seed: int) -> None:
    volume = a_volume(seed)
    twin = parafac(volume, rank=1, n_iter_max=500, tol=1e-14, init="svd")
    factors = [factor[:, 0] for factor in twin.factors]
    lengths = [np.linalg.norm(factor) for factor in factors]
    found = symmetric_rank1(volume)
    assert found.weight == pytest.approx(np.abs(twin.weights[0]) * np.prod(lengths), rel=1e-9)
    for mine, factor, length in zip(
        (found.primary, found.primary, found.secondary), factors, lengths, strict=True
    ):
        np.testing.assert_allclose(mine, np.abs(factor) / length, atol=1e-5)


def test_errors_fall_and_convergence_is_reported() -> None:
    found = symmetric_rank1(a_volume(3))
    assert (np.diff(found.errors) <= 1e-12).all()
    assert found.converged
    assert found.iterations < 30
    assert not symmetric_rank1(a_volume(3), max_iterations=1).converged


def test_iterations_stop_when_lambda_is_constant() -> None:
    found = symmetric_rank1(a_volume(3), min_change=1e-6)
    assert found.changes[-1] <= 1e-6
    assert found.iterations < symmetric_rank1(a_volume(3)).iterations
    longer = symmetric_rank1(a_volume(3), min_change=0.0, max_iterations=100)
    np.testing.assert_allclose(symmetric_rank1(a_volume(3)).primary, longer.primary, atol=1e-6)


def test_an_alternating_rho_converges() -> None:
    """One joint apart from twelve that coincide: lambda rests at once, rho never would."""
    star = np.zeros((13, 13, 4))
    star[0, 1:] = star[1:, 0] = 1.0
    found = symmetric_rank1(star)
    assert found.converged
    assert found.weight == pytest.approx(2 * np.sqrt(12))  # the eigenvalue, times |1 1 1 1|
    assert found.primary[0] == pytest.approx(np.sqrt(0.5))


def test_scale_changes_only_the_weight() -> None:
    once, thrice = symmetric_rank1(a_volume(4)), symmetric_rank1(3 * a_volume(4))
    assert thrice.weight == pytest.approx(3 * once.weight)
    np.testing.assert_allclose(thrice.primary, once.primary, atol=1e-12)


@pytest.mark.parametrize("frames", [1, 2])
def test_empty_and_tiny_volumes_give_no_nan(frames: int) -> None:
    found = symmetric_rank1(np.zeros((13, 13, frames)))
    assert found.weight == 0.0
    assert np.linalg.norm(found.primary) == pytest.approx(1.0)
    assert np.isfinite(symmetric_rank1(a_volume(1, frames=frames)).secondary).all()
