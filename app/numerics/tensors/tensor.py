"""Tensors unfolded, folded and multiplied along a mode (Vasilescu 2002, section 2).

Modes are counted from 0. Unfolding follows C order, as tensorly does: rows are the
chosen mode, columns the other modes in their own order with the last one running
fastest. Vasilescu and De Lathauwer run the columns cyclically; that permutes columns
only, so the column space, the mode matrices and the core are the same.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from app.numerics.arrays import FloatArray


def unfold(tensor: FloatArray, mode: int) -> FloatArray:
    """The mode's vectors as columns: (I_1, ..., I_N) -> (I_mode, product of the others)."""
    others = math.prod(tensor.shape[:mode] + tensor.shape[mode + 1 :])
    return np.moveaxis(tensor, mode, 0).reshape(tensor.shape[mode], others)


def fold(matrix: FloatArray, mode: int, shape: Sequence[int]) -> FloatArray:
    """The tensor of `shape` whose unfolding along `mode` is `matrix`; inverse of `unfold`."""
    others = [*shape[:mode], *shape[mode + 1 :]]
    return np.moveaxis(matrix.reshape(shape[mode], *others), 0, mode)


def mode_product(tensor: FloatArray, matrix: FloatArray, mode: int) -> FloatArray:
    """tensor x_mode matrix: (..., I_mode, ...) and (J, I_mode) -> (..., J, ...)."""
    shape = [*tensor.shape[:mode], matrix.shape[0], *tensor.shape[mode + 1 :]]
    return fold(matrix @ unfold(tensor, mode), mode, shape)


def multiply_modes(tensor: FloatArray, matrices: Sequence[FloatArray | None]) -> FloatArray:
    """tensor x_1 M_1 x_2 M_2 ..., one matrix a mode; None leaves its mode as it is."""
    for mode, matrix in enumerate(matrices):
        if matrix is not None:
            tensor = mode_product(tensor, matrix, mode)
    return tensor
