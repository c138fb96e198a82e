"""The shrinkage toward a sphere of a covariance matrix that was estimated from few samples."""

from __future__ import annotations

import numpy as np

from app.numerics.arrays import FloatArray


def oracle_share(covariance: FloatArray, freedom: float) -> float:
    """The best share, 0..1, of a sphere in a mixture with a sample covariance (d, d).

    The sphere has the same mean variance. freedom: the degrees of freedom of the covariance. The
    share is near 1 if the shape of the covariance can be chance, and small if few directions
    hold all the variance.

    Source: oracle approximating shrinkage (Chen, Wiesel, Eldar and Hero 2010, eq. 23).
    scikit-learn's OAS takes the samples and counts each of them. A scatter within classes has
    fewer degrees of freedom than samples, which this formula allows.
    """
    size = len(covariance)
    # tr(S^2) and tr(S)^2
    of_squares, square = float((covariance**2).sum()), float(np.trace(covariance)) ** 2
    numerator = (1 - 2 / size) * of_squares + square
    denominator = (freedom + 1 - 2 / size) * (of_squares - square / size)
    return 1.0 if denominator <= numerator else numerator / denominator
