"""Kernel ridge regression with a Gaussian kernel, tuned by itself.

Width and penalty minimize the leave-one-out error, which has a closed form. Above
MAX_CENTERS rows the kernel is spanned by a random subset (Nystroem), so that cost grows
with the number of rows, not with its cube. Shapes: rows n, inputs p, outputs q, centers m.

scikit-learn's KernelRidge stays out: it does not tune itself, and a search over the same grid
with only five folds takes 8 times as long (1.8 s against .22 for 500 clips, 131 inputs and 55
outputs; tests/bench/test_libraries.py).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.numerics.arrays import FloatArray
from app.numerics.euclidean import squared_distances

MAX_CENTERS = 2000
"""Rows that may be centers of the kernel."""

TUNING_ROWS = 1000
"""Rows on which width and penalty are chosen."""

WIDTHS = (0.125, 0.25, 0.5, 0.75, 1.0, 1.5, 2.5)
"""Candidates, as multiples of the median distance between rows."""

PENALTIES = (1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3, 1.0, 3.0)
"""Candidates for the ridge penalty."""

_BLOCK = 1000
"""Rows handled at once: bounds memory to _BLOCK * m floats."""


@dataclass(frozen=True, slots=True)
class KernelRidge:
    """centers (m, p), weights (m, q), offset (q,), width in the inputs' unit, and the
    penalty that was used. Far from all centers the prediction is the offset.
    """

    centers: FloatArray
    weights: FloatArray
    offset: FloatArray
    width: float
    penalty: float

    def predict(self, rows: FloatArray) -> FloatArray:
        """(n, q) outputs for `rows` (n, p)."""
        blocks = [
            self.offset
            + gaussian_kernel(rows[first : first + _BLOCK], self.centers, self.width) @ self.weights
            for first in range(0, len(rows), _BLOCK)
        ]
        return np.concatenate([np.zeros((0, len(self.offset))), *blocks])


def fit_kernel_ridge(rows: FloatArray, outputs: FloatArray, *, seed: int = 0) -> KernelRidge:
    """Fit `outputs` (n, q) on `rows` (n, p), n >= 1; deterministic for a seed."""
    order = np.random.RandomState(seed).permutation(len(rows))
    offset = outputs.mean(axis=0)
    tuning = np.sort(order[:TUNING_ROWS])
    width, penalty = _tune(rows[tuning], outputs[tuning] - offset)
    centers = rows[np.sort(order[:MAX_CENTERS])]
    weights = _solve(rows, outputs - offset, centers, width, penalty)
    return KernelRidge(centers, weights, offset, width, penalty)


def refit_kernel_ridge(
    like: KernelRidge, rows: FloatArray, outputs: FloatArray, *, seed: int = 0
) -> KernelRidge:
    """As fit_kernel_ridge, with the width and penalty of another: cheap, for folds of its rows."""
    order = np.random.RandomState(seed).permutation(len(rows))
    offset = outputs.mean(axis=0)
    centers = rows[np.sort(order[:MAX_CENTERS])]
    weights = _solve(rows, outputs - offset, centers, like.width, like.penalty)
    return KernelRidge(centers, weights, offset, like.width, like.penalty)


def gaussian_kernel(left: FloatArray, right: FloatArray, width: float) -> FloatArray:
    """(n, m) exp(-|l - r|^2 / (2 width^2)) of `left` (n, p) and `right` (m, p)."""
    return np.asarray(np.exp(squared_distances(left, right) / (-2.0 * width**2)))


def leave_one_out_errors(kernel: FloatArray, outputs: FloatArray) -> FloatArray:
    """(penalties,) mean squared error of predicting each row from all others.

    kernel: (n, n); outputs: (n, q) without their mean. One eigendecomposition serves all
    PENALTIES: the residual of row i is alpha_i / [(K + penalty)^-1]_ii.
    """
    values, vectors = np.linalg.eigh(kernel)
    turned = vectors.T @ outputs
    errors = []
    for penalty in PENALTIES:
        inverse = 1.0 / (np.maximum(values, 0.0) + penalty)
        diagonal = (vectors**2) @ inverse
        alpha = vectors @ (turned * inverse[:, None])
        errors.append(float(((alpha / diagonal[:, None]) ** 2).mean()))
    return np.array(errors)


def _tune(rows: FloatArray, outputs: FloatArray) -> tuple[float, float]:
    """Width and penalty of least leave-one-out error; the widest, stiffest of equals."""
    squares = squared_distances(rows, rows)
    apart = np.sqrt(squares[np.triu_indices(len(rows), 1)])
    unit = float(np.median(apart)) if apart.size and np.median(apart) > 0.0 else 1.0
    best, chosen = np.inf, (unit, PENALTIES[-1])
    for share in reversed(WIDTHS):
        errors = leave_one_out_errors(np.exp(squares / (-2.0 * (share * unit) ** 2)), outputs)
        least = int(np.argmin(errors))
        if errors[least] < best:
            best, chosen = errors[least], (share * unit, PENALTIES[least])
    return chosen


def _solve(
    rows: FloatArray, outputs: FloatArray, centers: FloatArray, width: float, penalty: float
) -> FloatArray:
    """(m, q) weights; with all rows as centers the exact kernel ridge solution."""
    among = gaussian_kernel(centers, centers, width)
    if len(centers) == len(rows):
        return np.asarray(np.linalg.solve(among + penalty * np.eye(len(rows)), outputs))
    normal, target = penalty * among, np.zeros((len(centers), outputs.shape[1]))
    for first in range(0, len(rows), _BLOCK):
        block = gaussian_kernel(rows[first : first + _BLOCK], centers, width)
        normal += block.T @ block
        target += block.T @ outputs[first : first + _BLOCK]
    jitter = 1e-8 * float(np.trace(normal)) / len(centers)
    return np.asarray(np.linalg.solve(normal + jitter * np.eye(len(centers)), target))
