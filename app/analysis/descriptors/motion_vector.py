"""The motion vector (DESIGN 5 and 13): a clip as 128 floats, compared by Euclidean distance.

What two people do alike when they do the same, whatever their style: how the body is held on
the whole (means), how far each joint moves around where it is at the time (a wave) and how
that place itself wanders (an arm that is raised), the order of things (the first two cosines
over the clip), how the body travels, sways and turns. Beside these the features' covariance
as a matrix logarithm (where such matrices have a Euclidean geometry: Arsigny et al. 2006),
which tells more of manner. All through one fixed random projection: nothing is fitted on a
library, so vectors stay comparable for years. The wide motion vector is the same through a
projection of 512: slower to search by, it keeps finer differences, by which the recogniser
tells whom and what it knows (app.models.recognition.recognizer).

The weights were chosen by hand on half of dataset 2's styles, dataset 1, CMU's clips and the
demo library (`tests/bench/test_retrieval.py` has the curve). None of it depends on the phase
of a gait, on which a clip's start and end would otherwise tell.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import scipy
from numpy.typing import NDArray

from app.analysis.descriptors.frame_features import FEATURES
from app.motion.frame.body_frame import ANALYSIS_RATE
from app.numerics.arrays import FloatArray

DIMENSIONS = 128
WIDE_DIMENSIONS = 512
RIDGE = 1e-3
"""Added to the covariance's diagonal: the logarithm's floor for what stands still."""

COVARIANCE_SCALE = 1 / 20
"""Brings the logarithm's entries to the size of the rest."""

SLOW = 1.0
"""Seconds (standard deviation): what lasts longer is a place, what does not is movement."""

PLACE_WEIGHT = 0.75
MOVEMENT_WEIGHT = 1.3
WANDERING_WEIGHT = 2.5
"""Of mean places, of movement about them, of how they wander; per body length."""

TRAVEL_WEIGHTS = (2.0, 1.0, 1.0)
"""Of the mean velocity to the left, up and forward: people walk at many speeds, and sideways
only when they mean to."""

SWAY_WEIGHT = 0.7
"""Of the velocity's standard deviation."""

TURNING = 0.3
"""Radians per second: mean yaw rates count in proportion below, by their logarithm above."""

TURNS_WEIGHT = 0.5
"""Of the slow yaw rate's standard deviation, per radian per second."""

SEED = 20111
"""Of the projections; changing it changes every stored vector."""

PLACES, VELOCITY, YAW_RATE = slice(0, 39), slice(78, 81), 81
"""Columns of the frame features."""

DESCRIBED = 5 * 39 + 3 + 3 + 1 + 1 + FEATURES * (FEATURES + 1) // 2
"""Numbers of a motion before the projection: 3606."""


def motion_vector(features: FloatArray) -> FloatArray:
    """(128,) float32 motion vector of frame features (n, 82) at ANALYSIS_RATE, n >= 1."""
    return narrow(describe(features))


def describe(features: FloatArray) -> FloatArray:
    """(3606,) the numbers that motion vectors are projected from, of frame features (n, 82)."""
    return np.concatenate([course(features), log_covariance(features)])


def narrow(described: FloatArray) -> FloatArray:
    """(128,) float32 the motion vector, from `describe` (3606,)."""
    return np.asarray(described @ projection(DIMENSIONS), dtype=np.float32)


def wide(described: FloatArray) -> FloatArray:
    """(512,) float32 the wide motion vector, from `describe` (3606,)."""
    return np.asarray(described.astype(np.float32) @ _wide_projection())


def course(features: FloatArray) -> FloatArray:
    """(203,) weighted means, movement, wandering, order, travel, sway and turning; see above."""
    places, velocity, yaw = features[:, PLACES], features[:, VELOCITY], features[:, YAW_RATE]
    slow = _slowly(places)
    about = np.sqrt(np.maximum(_slowly(np.square(places - slow)), 0.0))
    return np.concatenate(
        [
            PLACE_WEIGHT * places.mean(axis=0),
            MOVEMENT_WEIGHT * about.mean(axis=0),
            WANDERING_WEIGHT * slow.std(axis=0),
            *_first_cosines(places),
            velocity.mean(axis=0) * TRAVEL_WEIGHTS,
            SWAY_WEIGHT * velocity.std(axis=0),
            [np.arcsinh(yaw.mean() / TURNING)],
            [TURNS_WEIGHT * _slowly(yaw, SLOW / 2).std()],
        ]
    )


def _slowly(values: FloatArray, seconds: float = SLOW) -> FloatArray:
    """`values` (n, ...) without what is faster than `seconds`; held at the ends.

    Three running means of 2 `seconds` have the standard deviation of a Gaussian of `seconds`,
    nearly its shape, and cost the same however slow they are.
    """
    width = 2 * round(seconds * ANALYSIS_RATE) + 1
    for _ in range(3):
        values = scipy.ndimage.uniform_filter1d(values, width, axis=0, mode="nearest")
    return values


def _first_cosines(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(d,) each: how `values` (n, d) go from start to end, and at both ends from the middle."""
    angles = np.pi * (np.arange(len(values)) + 0.5) / len(values)
    first, second = (
        np.sqrt(2.0) * (np.cos(order * angles) @ values) / len(values) for order in (1, 2)
    )
    return first, second


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
def _wide_projection() -> NDArray[np.float32]:
    """(3606, 512); half the precision, since all of it is read for each clip."""
    return projection(WIDE_DIMENSIONS).astype(np.float32)


@lru_cache(maxsize=1)
def projection(dimensions: int = DIMENSIONS) -> FloatArray:
    """(3606, dimensions) Gaussian, of variance 1 over `dimensions`; the same for ever.

    `RandomState` because its stream is frozen by numpy's policy; `Generator`'s is not.
    """
    stream = np.random.RandomState(SEED)
    drawn: FloatArray = stream.standard_normal((DESCRIBED, dimensions)) / np.sqrt(dimensions)
    drawn.setflags(write=False)
    return drawn
