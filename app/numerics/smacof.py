"""Multidimensional scaling by majorization (SMACOF: de Leeuw 1977; Borg and Groenen, ch. 8).

It minimizes the raw stress: the sum over pairs of (distance - given distance)^2. Eq. 3 of Takano
compares squared distances instead (app.numerics.mds). scikit-learn does the work: 166 symbols in
1 to 15 dimensions take 1.2 s. Shapes: points N, dimensions d.
"""

from __future__ import annotations

import numpy as np

from app.numerics.arrays import FloatArray
from app.numerics.mds import classical_mds

STEPS = 300
"""The largest number of iterations."""


def smacof(distances: FloatArray, dimensions: int) -> FloatArray:
    """(N, d) coordinates that minimize the raw stress for `distances` (N, N), of any unit.

    distances: symmetric, zeros on the diagonal. dimensions: d. The start is classical scaling
    with fixed signs, so the result is deterministic. Fewer than three points, and points that
    are all equal, keep their classical coordinates.
    """
    from sklearn.manifold import smacof as majorized  # slow to load

    target = np.asarray(distances, dtype=np.float64)
    start = classical_mds(target, dimensions)
    if len(start) < 3 or not target.any():  # scikit-learn divides by the stress
        return start
    points, _ = majorized(
        (target + target.T) / 2,
        n_components=dimensions,
        init=start,
        n_init=1,
        max_iter=STEPS,
        normalized_stress=False,
    )
    return np.asarray(points, dtype=np.float64)
