"""Canonical correlation analysis (Takano, eqs 5-14), with ridge and pseudo-inverse.

The paper's X and Y are taken as centered (eqs 8-10 are covariances only then). The two
eigenvalue problems of eqs 13-14 are solved as one singular value decomposition of the
whitened cross-covariance. Label vectors are rank deficient, so directions without
variance are left out (pseudo-inverse) and the rest is held by a ridge.
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
    """x_mean (p,), y_mean (q,); a (p, k) and b (q, k) project centered vectors onto the
    canonical spaces; correlations (k,), falling, those of eq. 7 shrunk by the ridge.
    """

    x_mean: FloatArray
    y_mean: FloatArray
    a: FloatArray
    b: FloatArray
    correlations: FloatArray


def fit_cca(x: FloatArray, y: FloatArray, *, ridge: float) -> CanonicalPair:
    """Fit on `x` (n, p) and `y` (n, q), n >= 2.

    ridge: share of each side's mean variance that is added to its covariance.
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
    """(p, r) W with W' (S + ridge) W = I on the r directions that vary."""
    covariance = centered.T @ centered / (len(centered) - 1)
    values, vectors = np.linalg.eigh(covariance)
    is_kept = values > max(MIN_VARIANCE * float(values[-1]), 1e-15)
    if not is_kept.any():
        return np.zeros((len(values), 1))  # nothing varies: everything projects to zero
    added = ridge * float(values.mean())
    return np.asarray(vectors[:, is_kept] / np.sqrt(values[is_kept] + added))
