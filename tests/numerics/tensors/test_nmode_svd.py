from __future__ import annotations

import numpy as np
import pytest
import tensorly
from tensorly.decomposition import tucker

from app.numerics.tensors.nmode_svd import mode_matrix, nmode_svd
from app.numerics.tensors.tensor import unfold


@pytest.fixture
def tensor() -> np.ndarray:
    return np.random.default_rng(4).normal(size=(4, 3, 20))


def test_full_ranks_reconstruct_the_tensor(tensor: np.ndarray) -> None:
    model = nmode_svd(tensor)
    assert [factor.shape for factor in model.factors] == [(4, 4), (3, 3), (20, 12)]
    np.testing.assert_allclose(model.reconstruct(), tensor, atol=1e-12)


def test_mode_matrices_are_orthonormal_and_the_core_all_orthogonal(tensor: np.ndarray) -> None:
    model = nmode_svd(tensor)
    for mode, factor in enumerate(model.factors):
        np.testing.assert_allclose(factor.T @ factor, np.eye(factor.shape[1]), atol=1e-12)
        gram = unfold(model.core, mode) @ unfold(model.core, mode).T
        np.testing.assert_allclose(gram, np.diag(np.diag(gram)), atol=1e-10)


def test_truncated_ranks_agree_with_tensorlys_first_step(tensor: np.ndarray) -> None:
    ranks = [2, 2, 5]
    ours = nmode_svd(tensor, ranks)
    core, factors = tucker(tensor, rank=ranks, n_iter_max=0, init="svd")
    theirs = tensorly.tucker_to_tensor((core, factors))
    assert ours.core.shape == (2, 2, 5)
    for mine, other in zip(ours.factors, factors, strict=True):
        np.testing.assert_allclose(mine @ mine.T, other @ other.T, atol=1e-10)
    np.testing.assert_allclose(ours.reconstruct(), theirs, atol=1e-8)


def test_two_modes_are_the_svd() -> None:
    matrix = np.random.default_rng(5).normal(size=(5, 3))
    core = nmode_svd(matrix).core
    expected = np.diag(np.linalg.svd(matrix, compute_uv=False))
    np.testing.assert_allclose(np.abs(core), expected, atol=1e-12)


def test_signs_do_not_depend_on_the_sign_of_the_data(tensor: np.ndarray) -> None:
    for mode in range(3):
        there, back = mode_matrix(tensor, mode), mode_matrix(-tensor, mode)
        np.testing.assert_allclose(there, back, atol=1e-12)


def test_a_tensor_of_zeros_decomposes() -> None:
    model = nmode_svd(np.zeros((2, 3, 4)))
    assert np.isfinite(model.reconstruct()).all()
