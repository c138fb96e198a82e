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
    """core: (R_1, ..., R_N); factors: N mode matrices (I_n, R_n), columns orthonormal."""

    core: FloatArray
    factors: tuple[FloatArray, ...]

    def reconstruct(self) -> FloatArray:
        """The tensor (I_1, ..., I_N) of eq. 1; exact at full ranks."""
        return multiply_modes(self.core, self.factors)


def nmode_svd(tensor: FloatArray, ranks: Sequence[int | None] | None = None) -> NModeSVD:
    """Decompose a tensor (I_1, ..., I_N) by the two steps of Vasilescu's algorithm.

    ranks: columns to keep of each mode matrix; None keeps all that the unfolding can have,
    min(I_n, product of the others). Truncating is the truncated HOSVD: not the best
    approximation of these ranks, but within a factor sqrt(N) of it, and without iteration.
    """
    wanted = ranks if ranks is not None else [None] * tensor.ndim
    factors = tuple(mode_matrix(tensor, mode, rank) for mode, rank in enumerate(wanted))
    core = multiply_modes(tensor, [factor.T for factor in factors])
    return NModeSVD(core, factors)


def mode_matrix(tensor: FloatArray, mode: int, rank: int | None = None) -> FloatArray:
    """Left singular vectors of the unfolding along `mode`: (I_mode, rank), signs fixed."""
    flat = unfold(tensor, mode)
    left, _, _ = np.linalg.svd(flat, full_matrices=False)
    return fix_signs(left[:, :rank])
