"""How far a covariance of few samples must be pulled toward a sphere to be believed."""

from __future__ import annotations

import numpy as np

from app.numerics.arrays import FloatArray


def oracle_share(covariance: FloatArray, freedom: float) -> float:
    """The share, 0..1, of the sphere of the same mean variance that is best mixed into a sample
    covariance (d, d) of so many degrees of freedom: near 1 where its shape is no more than
    chance, small where few directions hold all variance.

    Oracle approximating shrinkage: Chen, Wiesel, Eldar, Hero 2010, eq. 23. scikit-learn's OAS
    takes the samples and counts each of them; a scatter within classes has fewer degrees of
    freedom, which only this formula takes.
    """
    size = len(covariance)
    of_squares, square = float((covariance**2).sum()), float(np.trace(covariance)) ** 2
    wanted = (1 - 2 / size) * of_squares + square
    given = (freedom + 1 - 2 / size) * (of_squares - square / size)
    return 1.0 if given <= wanted else wanted / given
