from __future__ import annotations

import numpy as np
import pytest
import tensorly
from hypothesis import given
from hypothesis import strategies as st

from app.numerics.tensors.tensor import fold, mode_product, multiply_modes, unfold

SHAPE = (3, 4, 5)


@pytest.fixture
def tensor() -> np.ndarray:
    return np.random.default_rng(1).normal(size=SHAPE)


def naive_mode_product(tensor: np.ndarray, matrix: np.ndarray, mode: int) -> np.ndarray:
    """The sum over i_n of section 2, written out."""
    shape = list(tensor.shape)
    shape[mode] = matrix.shape[0]
    product = np.zeros(shape)
    for index in np.ndindex(*shape):
        for i in range(tensor.shape[mode]):
            source = (*index[:mode], i, *index[mode + 1 :])
            product[index] += tensor[source] * matrix[index[mode], i]
    return product


@pytest.mark.parametrize("mode", range(3))
def test_unfolding_is_tensorlys(tensor: np.ndarray, mode: int) -> None:
    np.testing.assert_array_equal(unfold(tensor, mode), tensorly.unfold(tensor, mode))


@given(shape=st.lists(st.integers(1, 4), min_size=1, max_size=4), data=st.data())
def test_folding_undoes_unfolding(shape: list[int], data: st.DataObject) -> None:
    mode = data.draw(st.integers(0, len(shape) - 1))
    tensor = np.arange(float(np.prod(shape))).reshape(shape)
    np.testing.assert_array_equal(fold(unfold(tensor, mode), mode, shape), tensor)


def test_the_columns_of_an_unfolding_are_the_modes_vectors(tensor: np.ndarray) -> None:
    np.testing.assert_array_equal(unfold(tensor, 1)[:, 2 * 5 + 3], tensor[2, :, 3])


@pytest.mark.parametrize("mode", range(3))
def test_mode_product_is_the_sum_of_the_paper(tensor: np.ndarray, mode: int) -> None:
    matrix = np.random.default_rng(2).normal(size=(2, SHAPE[mode]))
    fast = mode_product(tensor, matrix, mode)
    np.testing.assert_allclose(fast, naive_mode_product(tensor, matrix, mode), atol=1e-12)
    np.testing.assert_allclose(fast, tensorly.tenalg.mode_dot(tensor, matrix, mode), atol=1e-12)


def test_products_along_different_modes_commute(tensor: np.ndarray) -> None:
    rng = np.random.default_rng(3)
    first, last = rng.normal(size=(2, 3)), rng.normal(size=(6, 5))
    one_way = mode_product(mode_product(tensor, first, 0), last, 2)
    np.testing.assert_allclose(multiply_modes(tensor, [first, None, last]), one_way, atol=1e-12)
    other_way = mode_product(mode_product(tensor, last, 2), first, 0)
    np.testing.assert_allclose(one_way, other_way, atol=1e-12)
