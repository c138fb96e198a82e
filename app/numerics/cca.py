"""Canonical correlation analysis (Takano, eqs 5-14), with a ridge and a pseudo-inverse.

X and Y are centered first, because eqs 8-10 are covariances only then. One singular value
decomposition of the whitened cross-covariance solves both eigenvalue problems of eqs 13-14.
Label vectors are rank deficient. So directions without variance are left out (this is the
pseudo-inverse), and a ridge keeps the other directions stable.

Shapes: examples n, inputs p, labels q, canonical dimensions k.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.numerics.arrays import FloatArray
from app.numerics.signs import column_signs

MIN_VARIANCE = 1e-9
"""Directions with less variance than this share of the largest are left out."""


@dataclass(frozen=True, slots=True)
class CanonicalPair:
    """The projections onto two canonical spaces, in which X and Y correlate most.

    x_mean: (p,) and y_mean: (q,) are the means of the examples. a: (p, k) and b: (q, k) project
    centered vectors: `(x - x_mean) @ a`. correlations: (k,) in falling order, 0..1, as in eq. 7
    but made smaller by the ridge.
    """

    x_mean: FloatArray
    y_mean: FloatArray
    a: FloatArray
    b: FloatArray
    correlations: FloatArray


def fit_cca(x: FloatArray, y: FloatArray, *, ridge: float) -> CanonicalPair:
    """Fit both projections to the paired rows of `x` (n, p) and `y` (n, q).

    At least two rows are needed. ridge: 0 or more; this share of a side's mean variance is added
    to the diagonal of its covariance. The result is deterministic: in each column of `a` the
    entry of largest magnitude is positive. k is the smaller of the two numbers of directions
    that vary. A side in which nothing varies is projected to zero, with k = 1.
    """
    x_mean, y_mean = x.mean(axis=0), y.mean(axis=0)
    x_centered, y_centered = x - x_mean, y - y_mean
    whiten_x, whiten_y = _whitener(x_centered, ridge), _whitener(y_centered, ridge)
    cross = whiten_x.T @ (x_centered.T @ y_centered / (len(x) - 1)) @ whiten_y
    left, correlations, right = np.linalg.svd(cross, full_matrices=False)
    a, b = whiten_x @ left, whiten_y @ right.T
    signs = column_signs(a)
    return CanonicalPair(x_mean, y_mean, a * signs, b * signs, correlations)


def _whitener(centered: FloatArray, ridge: float) -> FloatArray:
    """(p, r) the matrix W with W' (S + ridge) W = I, where S is the covariance of `centered`.

    centered: (n, p). r is the number of directions that vary, and 1 if none does (W is 0 then).
    """
    covariance = centered.T @ centered / (len(centered) - 1)
    values, vectors = np.linalg.eigh(covariance)
    is_kept = values > max(MIN_VARIANCE * float(values[-1]), 1e-15)
    if not is_kept.any():
        return np.zeros((len(values), 1))  # nothing varies: everything projects to zero
    added = ridge * float(values.mean())
    return np.asarray(vectors[:, is_kept] / np.sqrt(values[is_kept] + added))
