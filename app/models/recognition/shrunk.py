"""Covariances that are shrunk toward a sphere, so that they can be inverted."""

from __future__ import annotations

import numpy as np

from app.numerics.arrays import FloatArray

SHRINKAGE = 0.1
"""Share of each covariance that is replaced by a sphere of the same mean variance. Within cells
the share is larger if there are too few repeated takes to estimate the shape."""

MIN_VARIANCE = 1e-6
"""Smallest mean variance, in squared body lengths. It avoids a division by 0 for equal takes."""


def shrunk(covariance: FloatArray, share: float = SHRINKAGE) -> FloatArray:
    """(d, d) `covariance` mixed with a sphere of its mean variance, so that it is invertible."""
    size = max(len(covariance), 1)
    mean = max(float(np.trace(covariance)) / size, MIN_VARIANCE)
    return (1 - share) * covariance + share * mean * np.eye(len(covariance))


def second_moment(errors: FloatArray) -> FloatArray:
    """(d, d) the shrunk mean of the outer products of `errors` (n, d)."""
    return shrunk(errors.T @ errors / len(errors))
