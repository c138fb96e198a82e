"""The motion vector (DESIGN 5 and 13): a clip as 128 floats, compared by Euclidean distance.

The features' covariance over the clip, as a matrix logarithm (where such matrices have a
Euclidean geometry: Arsigny et al. 2006), beside their mean, through one fixed random
projection. Nothing is fitted on a library, so vectors stay comparable for years.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from app.analysis.frame_features import FEATURES
from app.numerics.arrays import FloatArray

DIMENSIONS = 128
RIDGE = 1e-3
"""Added to the covariance's diagonal: the logarithm's floor for what stands still."""

COVARIANCE_SCALE = 1 / 20
"""Brings the logarithm's entries to the size of the mean's."""

SEED = 20111
"""Of the projection; changing it changes every stored vector."""


def motion_vector(features: FloatArray) -> FloatArray:
    """(128,) float32 motion vector of frame features (n, 82), n >= 1."""
    described = np.concatenate([log_covariance(features), features.mean(axis=0)])
    return np.asarray(described @ projection(), dtype=np.float32)


def log_covariance(features: FloatArray) -> FloatArray:
    """(3403,): the upper triangle of log(cov + RIDGE I), scaled; features (n, 82).

    Off-diagonals carry sqrt 2, so that Euclidean distance is the matrices' Frobenius one.
    """
    count = features.shape[1]
    centred = features - features.mean(axis=0)
    covariance = centred.T @ centred / len(features)
    values, vectors = np.linalg.eigh(covariance + RIDGE * np.eye(count))
    # eigenvalues are >= RIDGE but for rounding
    logarithm = (vectors * np.log(np.maximum(values, RIDGE))) @ vectors.T
    weights = np.where(np.eye(count, dtype=bool), 1.0, np.sqrt(2.0))
    return np.asarray((weights * logarithm)[np.triu_indices(count)] * COVARIANCE_SCALE)


@lru_cache(maxsize=1)
def projection() -> FloatArray:
    """(3485, 128) Gaussian, columns of unit variance over DIMENSIONS; the same for ever.

    `RandomState` because its stream is frozen by numpy's policy; `Generator`'s is not.
    """
    described = FEATURES * (FEATURES + 1) // 2 + FEATURES
    stream = np.random.RandomState(SEED)
    drawn: FloatArray = stream.standard_normal((described, DIMENSIONS)) / np.sqrt(DIMENSIONS)
    drawn.setflags(write=False)
    return drawn
