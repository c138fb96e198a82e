"""Tensors unfolded, folded and multiplied along a mode (Vasilescu 2002, section 2).

Modes are counted from 0. Unfolding follows C order, as in tensorly. The rows are the chosen mode.
The columns are the other modes in their own order, and the last one varies fastest. Vasilescu and
De Lathauwer order the columns cyclically. That only permutes the columns, so the mode matrices
and the core are the same.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from app.numerics.arrays import FloatArray


def unfold(tensor: FloatArray, mode: int) -> FloatArray:
    """The tensor (I_1, ..., I_N) as a matrix (I_mode, product of the other sizes)."""
    others = math.prod(tensor.shape[:mode] + tensor.shape[mode + 1 :])
    return np.moveaxis(tensor, mode, 0).reshape(tensor.shape[mode], others)


def fold(matrix: FloatArray, mode: int, shape: Sequence[int]) -> FloatArray:
    """The tensor of `shape` whose unfolding along `mode` is `matrix`: the inverse of `unfold`."""
    others = [*shape[:mode], *shape[mode + 1 :]]
    return np.moveaxis(matrix.reshape(shape[mode], *others), 0, mode)


def mode_product(tensor: FloatArray, matrix: FloatArray, mode: int) -> FloatArray:
    """tensor x_mode matrix: of (..., I_mode, ...) and (J, I_mode) the tensor (..., J, ...)."""
    shape = [*tensor.shape[:mode], matrix.shape[0], *tensor.shape[mode + 1 :]]
    return fold(matrix @ unfold(tensor, mode), mode, shape)


def multiply_modes(tensor: FloatArray, matrices: Sequence[FloatArray | None]) -> FloatArray:
    """tensor x_1 M_1 x_2 M_2 ...

    matrices: one (J_n, I_n) for each mode, in order; None leaves a mode as it is.
    """
    for mode, matrix in enumerate(matrices):
        if matrix is not None:
            tensor = mode_product(tensor, matrix, mode)
    return tensor
