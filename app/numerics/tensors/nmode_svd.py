"""N-mode SVD: the multilinear extension of the SVD (Vasilescu 2002, section 2, eqs 1-2).

D = Z x_1 U_1 x_2 U_2 ... x_N U_N with orthonormal mode matrices U_n and a full core Z.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.numerics.arrays import FloatArray
from app.numerics.signs import fix_signs
from app.numerics.tensors.tensor import multiply_modes, unfold


@dataclass(frozen=True, slots=True)
class NModeSVD:
    """A decomposed tensor: core x_1 factors[0] x_2 factors[1] ... (eq. 1).

    core: (R_1, ..., R_N). factors: N mode matrices (I_n, R_n) with orthonormal columns.
    """

    core: FloatArray
    factors: tuple[FloatArray, ...]

    def reconstruct(self) -> FloatArray:
        """The tensor (I_1, ..., I_N) of eq. 1. It is exact if no rank was truncated."""
        return multiply_modes(self.core, self.factors)


def nmode_svd(tensor: FloatArray, ranks: Sequence[int | None] | None = None) -> NModeSVD:
    """Decompose a tensor (I_1, ..., I_N) by the two steps of Vasilescu's algorithm.

    ranks: for each mode the number of columns to keep. None keeps all that the unfolding has:
    min(I_n, product of the other sizes). With smaller ranks the result is the truncated HOSVD.
    It needs no iteration, and its error is within a factor sqrt(N) of the smallest possible.
    """
    mode_ranks = ranks if ranks is not None else [None] * tensor.ndim
    factors = tuple(mode_matrix(tensor, mode, rank) for mode, rank in enumerate(mode_ranks))
    core = multiply_modes(tensor, [factor.T for factor in factors])
    return NModeSVD(core, factors)


def mode_matrix(tensor: FloatArray, mode: int, rank: int | None = None) -> FloatArray:
    """(I_mode, rank) the first left singular vectors of the unfolding along `mode`.

    mode: counted from 0. rank: None keeps all. In each column the entry of largest magnitude is
    positive.
    """
    flat = unfold(tensor, mode)
    left, _, _ = np.linalg.svd(flat, full_matrices=False)
    return fix_signs(left[:, :rank])
