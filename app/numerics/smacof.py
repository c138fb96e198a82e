"""Multidimensional scaling by majorisation (SMACOF: de Leeuw 1977; Borg and Groenen, ch. 8).

Minimises the raw stress, the sum over pairs of (distance - wanted)^2, where eq. 3 of Takano
compares squares (app.numerics.mds). Each step is a Guttman transform, which never raises the
stress. Starts from classical scaling, so that the result is deterministic. Points N,
dimensions d.
"""

from __future__ import annotations

import numpy as np
import scipy

from app.numerics.arrays import FloatArray
from app.numerics.mds import classical_mds

STEPS = 300
LEAST_GAIN = 1e-6
"""Stop when a step lowers the stress by less than this share of it."""

_SMALLEST = 1e-12


def smacof(distances: FloatArray, dimensions: int) -> FloatArray:
    """(N, d) coordinates that minimise the raw stress for symmetric `distances` (N, N)."""
    wanted = np.asarray(distances, dtype=np.float64)
    points = classical_mds(wanted, dimensions)
    if len(points) < 3:
        return points
    reached = scipy.spatial.distance.cdist(points, points)
    before = _stress(reached, wanted)
    for _ in range(STEPS):
        points = _guttman(points, reached, wanted)
        reached = scipy.spatial.distance.cdist(points, points)
        after = _stress(reached, wanted)
        if before - after <= LEAST_GAIN * before:
            break
        before = after
    return points


def raw_stress(points: FloatArray, distances: FloatArray) -> float:
    """Sum over pairs i < j of (|x_i - x_j| - wanted)^2 for `points` (N, d)."""
    return _stress(
        scipy.spatial.distance.cdist(points, points), np.asarray(distances, dtype=np.float64)
    )


def _stress(reached: FloatArray, wanted: FloatArray) -> float:
    return float(np.square(reached - wanted).sum() / 2.0)


def _guttman(points: FloatArray, reached: FloatArray, wanted: FloatArray) -> FloatArray:
    ratio = np.where(reached > _SMALLEST, wanted / np.maximum(reached, _SMALLEST), 0.0)
    np.fill_diagonal(ratio, 0.0)
    return np.asarray((ratio.sum(axis=1)[:, None] * points - ratio @ points) / len(points))
