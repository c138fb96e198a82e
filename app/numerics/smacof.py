"""Multidimensional scaling by majorization (SMACOF: de Leeuw 1977; Borg and Groenen, ch. 8).

It minimizes the raw stress, the sum over pairs of (distance - wanted)^2, where eq. 3 of Takano
compares squares (app.numerics.mds). scikit-learn does it; for 166 symbols in 1 to 15 dimensions
it takes 1.2 s, as long as our own loop took. Points N, dimensions d.
"""

from __future__ import annotations

import numpy as np

from app.numerics.arrays import FloatArray
from app.numerics.mds import classical_mds

STEPS = 300


def smacof(distances: FloatArray, dimensions: int) -> FloatArray:
    """(N, d) coordinates that minimize the raw stress for symmetric `distances` (N, N).

    They start from classical scaling, whose signs are fixed, so the result is deterministic.
    """
    from sklearn.manifold import smacof as majorized  # slow to load

    wanted = np.asarray(distances, dtype=np.float64)
    start = classical_mds(wanted, dimensions)
    if len(start) < 3 or not wanted.any():  # scikit-learn divides by the stress
        return start
    points, _ = majorized(
        (wanted + wanted.T) / 2,
        n_components=dimensions,
        init=start,
        n_init=1,
        max_iter=STEPS,
        normalized_stress=False,
    )
    return np.asarray(points, dtype=np.float64)
