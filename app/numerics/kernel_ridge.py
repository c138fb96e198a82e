"""Kernel ridge regression with a Gaussian kernel that tunes itself.

Width and penalty are chosen to minimize the leave-one-out error, which has a closed form. With
more than MAX_CENTERS rows, a random subset of them spans the kernel (Nystroem's method). Then the
cost grows with the number of rows, not with its cube.
Shapes: rows n, inputs p, outputs q, centers m.

scikit-learn's KernelRidge is not used, because it does not tune itself. A search over the same
grid with only five folds took 8 times as long (1.8 s against .22 for 500 clips, 131 inputs and 55
outputs; tests/bench/test_libraries.py), before this one tried a part of the grid only.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy

from app.numerics.arrays import FloatArray
from app.numerics.euclidean import squared_distances

MAX_CENTERS = 2000
"""The largest number of rows that are centers of the kernel."""

TUNING_ROWS = 1000
"""The largest number of rows on which width and penalty are chosen."""

WIDTHS = (0.125, 0.25, 0.5, 0.75, 1.0, 1.5, 2.5)
"""Candidates for the width, as multiples of the median distance between rows."""

USUAL_WIDTH, USUAL_PENALTY = 3, 4
"""The places of the width and the penalty that are tried first."""

PENALTIES = (1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3, 1.0, 3.0)
"""Candidates for the ridge penalty."""

_BLOCK = 1000
"""The number of rows that are computed at once. It bounds the memory to _BLOCK * m floats."""


@dataclass(frozen=True, slots=True)
class KernelRidge:
    """A fitted regression: offset + kernel(rows, centers) @ weights.

    centers: (m, p). weights: (m, q). offset: (q,) the mean output, which is also the prediction
    far from all centers. width: of the kernel, in the unit of the inputs. penalty: the ridge
    penalty of the fit.
    """

    centers: FloatArray
    weights: FloatArray
    offset: FloatArray
    width: float
    penalty: float

    def predict(self, rows: FloatArray) -> FloatArray:
        """(n, q) the predicted outputs for `rows` (n, p); n may be 0."""
        blocks = [
            self.offset
            + gaussian_kernel(rows[first : first + _BLOCK], self.centers, self.width) @ self.weights
            for first in range(0, len(rows), _BLOCK)
        ]
        return np.concatenate([np.zeros((0, len(self.offset))), *blocks])


def fit_kernel_ridge(rows: FloatArray, outputs: FloatArray, *, seed: int = 0) -> KernelRidge:
    """Fit `outputs` (n, q) to `rows` (n, p), at least one; choose width and penalty.

    seed: of the random choice of TUNING_ROWS and MAX_CENTERS rows, if there are more than these.
    The result is deterministic for a seed.
    """
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
    """Fit `outputs` (n, q) to `rows` (n, p) with the width and penalty of `like`.

    As `fit_kernel_ridge` without its tuning, which takes most of the time. Cross-validation uses
    it for each fold.
    """
    order = np.random.RandomState(seed).permutation(len(rows))
    offset = outputs.mean(axis=0)
    centers = rows[np.sort(order[:MAX_CENTERS])]
    weights = _solve(rows, outputs - offset, centers, like.width, like.penalty)
    return KernelRidge(centers, weights, offset, like.width, like.penalty)


def gaussian_kernel(left: FloatArray, right: FloatArray, width: float) -> FloatArray:
    """(n, m) exp(-|l - r|^2 / (2 width^2)) for rows l of `left` (n, p) and r of `right` (m, p).

    width: above 0, in the unit of the rows.
    """
    return np.asarray(np.exp(squared_distances(left, right) / (-2.0 * width**2)))


def leave_one_out_error(kernel: FloatArray, outputs: FloatArray, penalty: float) -> float:
    """The mean squared error if each row is predicted from all others.

    kernel: (n, n) the Gaussian kernel of the rows. outputs: (n, q) less their mean. The residual of
    row i is alpha_i / [(K + penalty I)^-1]_ii, with alpha = (K + penalty I)^-1 outputs. The inverse
    takes a fifth of the time of an eigendecomposition, which would serve all penalties.
    """
    positive = kernel + penalty * np.eye(len(kernel))
    factor = scipy.linalg.cho_factor(positive, lower=True, overwrite_a=True, check_finite=False)
    alpha = scipy.linalg.cho_solve(factor, outputs, check_finite=False)
    inverse, _ = scipy.linalg.lapack.dpotri(factor[0], lower=True)
    return float(((alpha / np.diagonal(inverse)[:, None]) ** 2).mean())


def _tune(rows: FloatArray, outputs: FloatArray) -> tuple[float, float]:
    """The width and penalty with the smallest leave-one-out error.

    On real clips the error has one minimum along both. So the search begins at the usual ones, and
    goes on to neighbors as long as the error falls; for each width it begins at the penalty of the
    one before.
    """
    squares = squared_distances(rows, rows)
    distances = np.sqrt(squares[np.triu_indices(len(rows), 1)])
    # a single row, or mostly equal rows, have no typical distance
    unit = float(np.median(distances)) if distances.size and np.median(distances) > 0.0 else 1.0
    usual = USUAL_PENALTY

    def error_of_width(place: int) -> float:
        """The error with the best penalty for a width."""
        nonlocal usual
        kernel = np.exp(squares / (-2.0 * (WIDTHS[place] * unit) ** 2))
        usual, error = _lowest(
            lambda one: leave_one_out_error(kernel, outputs, PENALTIES[one]), usual, len(PENALTIES)
        )
        penalties[place] = PENALTIES[usual]
        return error

    penalties: dict[int, float] = {}
    place, _ = _lowest(error_of_width, USUAL_WIDTH, len(WIDTHS))
    return WIDTHS[place] * unit, penalties[place]


def _lowest(value: Callable[[int], float], start: int, count: int) -> tuple[int, float]:
    """The place 0 .. count - 1 with the lowest value, and the value, if there is one minimum.

    From `start` to higher places as long as the values fall, else to lower ones.
    """
    best, lowest = start, value(start)
    for places in (range(start + 1, count), range(start - 1, -1, -1)):
        if best != start:
            break
        for place in places:
            found = value(place)
            if found >= lowest:
                break
            best, lowest = place, found
    return best, lowest


def _solve(
    rows: FloatArray, outputs: FloatArray, centers: FloatArray, width: float, penalty: float
) -> FloatArray:
    """(m, q) the weights of the centers; the exact solution if all rows are centers."""
    among = gaussian_kernel(centers, centers, width)
    if len(centers) == len(rows):
        return _solved(among + penalty * np.eye(len(rows)), outputs)
    normal, target = penalty * among, np.zeros((len(centers), outputs.shape[1]))
    for first in range(0, len(rows), _BLOCK):
        block = gaussian_kernel(rows[first : first + _BLOCK], centers, width)
        normal += block.T @ block
        target += block.T @ outputs[first : first + _BLOCK]
    # centers that are nearly equal would make the matrix singular
    jitter = 1e-8 * float(np.trace(normal)) / len(centers)
    return _solved(normal + jitter * np.eye(len(centers)), target)


def _solved(positive: FloatArray, outputs: FloatArray) -> FloatArray:
    """(m, q) the solution for a positive definite matrix (m, m), in half the time of any other."""
    factor = scipy.linalg.cho_factor(positive, overwrite_a=True, check_finite=False)
    return np.asarray(scipy.linalg.cho_solve(factor, outputs, check_finite=False))
