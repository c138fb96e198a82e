"""Linear discriminants with shrinkage: directions in which classes differ, from few labels.

With few examples, the scatter within classes is far too small in some directions. Dividing by it
would amplify noise. So it is shrunk toward a sphere. scikit-learn estimates the share of the
sphere, by the method of Ledoit and Wolf ("A well-conditioned estimator for large-dimensional
covariance matrices", 2004).

The discriminants themselves are our own code. scikit-learn's LDA estimates a share for each
class, which two examples of a class do not allow. It also finds no directions beyond the C - 1
that separate C classes.

Shapes: examples n, dimensions d, classes C, directions k.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from app.numerics.arrays import FloatArray, IntArray
from app.numerics.signs import fix_signs

MIN_VARIANCE = 1e-12
"""The smallest mean variance within classes. It avoids a division by 0 for equal examples."""

MIN_SHRINKAGE = 1e-6
"""The smallest share of the sphere. It keeps the scatter invertible."""


@dataclass(frozen=True, slots=True)
class Discriminants:
    """Directions in which classes differ, in units of their spread within classes.

    axes: (d, k), the direction that separates the classes best first; `points @ axes` has unit
    variance within classes. between: (k,) the variance of the class means along each axis, 0
    for axes beyond the first C - 1. shrinkage: the share of the sphere, 0..1.
    """

    axes: FloatArray
    between: FloatArray
    shrinkage: float


def discriminants(
    points: FloatArray, labels: IntArray, count: int, shrinkage: float | None = None
) -> Discriminants:
    """The first `count` discriminants of `points` (n, d), at most d.

    labels: (n,) the class of each point, 0..C-1; each class needs at least one example. The
    first C - 1 directions separate the classes. The others are ordered by falling variance
    within classes. If no class has two examples, only the sphere is used (shrinkage 1).
    shrinkage: the share of the sphere, 0..1; None estimates it (see `shrinkage_within`).
    """
    rows = np.asarray(points, dtype=np.float64)
    means, sizes = _class_means(rows, labels)
    within = rows - means[labels]
    if shrinkage is None:
        shrinkage = shrinkage_within(within)
    values, vectors = scipy.linalg.eigh(_shrunk(within, len(rows) - len(sizes), shrinkage))
    whitening = vectors / np.sqrt(values)
    deviations = (means - rows.mean(axis=0)) * np.sqrt(sizes / sizes.sum())[:, None]
    separating, between = _separating(deviations @ whitening)
    rest = _by_variance(separating, values)
    axes = np.hstack([whitening @ separating, whitening @ rest])[:, :count]
    between = np.concatenate([between, np.zeros(rest.shape[1])])[:count]
    return Discriminants(fix_signs(axes), between, shrinkage)


def shrinkage_within(within: FloatArray) -> float:
    """The share of the sphere, 0..1, by Ledoit and Wolf; 1 if nothing varies.

    within: (n, d) deviations of the points from the means of their classes. All n rows count,
    although small classes leave fewer degrees of freedom. A correction for that was tried. It
    made the learned metrics worse: with two labeled clips for each task, precision at 20 was
    .846 with it and is .903 without it; with two clips for each person, .489 and .570. With
    eight clips or more there was no difference.
    """
    from sklearn.covariance import ledoit_wolf_shrinkage  # slow to load

    if not within.any():
        return 1.0
    return float(ledoit_wolf_shrinkage(within, assume_centered=True))


def _shrunk(within: FloatArray, freedom: int, shrinkage: float) -> FloatArray:
    """(d, d) the scatter of `within` (n, d), mixed with the sphere of its mean variance.

    freedom: the degrees of freedom of the scatter, n - C. shrinkage: the share of the sphere.
    """
    width = within.shape[1]
    square = within.T @ within / max(freedom, 1)
    mean = max(float(np.trace(square)) / width, MIN_VARIANCE)
    square *= 1.0 - shrinkage
    # a share of the sphere always stays, so that the result is invertible
    square += max(shrinkage, MIN_SHRINKAGE) * mean * np.eye(width)
    return np.asarray(square)


def _class_means(rows: FloatArray, labels: IntArray) -> tuple[FloatArray, FloatArray]:
    """The means (C, d) of the classes, and their numbers of rows (C,)."""
    sizes = np.bincount(labels).astype(np.float64)
    means = np.zeros((len(sizes), rows.shape[1]))
    np.add.at(means, labels, rows)
    return means / sizes[:, None], sizes


def _separating(deviations: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The directions (d, C-1) that separate classes, and the variances (C-1,) along them.

    deviations: (C, d) class means less the total mean, whitened, weighted by class size.
    """
    count = min(len(deviations) - 1, deviations.shape[1])
    _, lengths, directions = np.linalg.svd(deviations, full_matrices=False)
    return directions[:count].T, lengths[:count] ** 2


def _by_variance(separating: FloatArray, values: FloatArray) -> FloatArray:
    """(d, d-C+1) the directions orthogonal to `separating` (d, C-1), by falling variance.

    values: (d,) the variances within classes before whitening, one for each whitened dimension.
    """
    complement = np.linalg.svd(separating, full_matrices=True)[0][:, separating.shape[1] :]
    # eigenvalues rise, so the columns are reversed
    _, rotation = scipy.linalg.eigh((complement.T * values) @ complement)
    return np.asarray(complement @ rotation[:, ::-1])
