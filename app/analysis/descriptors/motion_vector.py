"""The motion vector: a clip as 128 floats, compared by Euclidean distance.

The first part describes what people have in common when they do the same, whatever their style:
- how the body is held (means);
- how far each joint moves around its slowly changing mean position, for example in a wave;
- how this mean position changes, for example when an arm is raised;
- the order of events (the first two cosines over the clip);
- how the body travels, sways and turns.

The second part is the logarithm of the features' covariance matrix, which says more about the
style. (Logarithms of such matrices have a Euclidean geometry: Arsigny et al. 2006.) A fixed random
projection maps both parts to 128 numbers. Nothing is fitted to a library, so vectors stay
comparable for years. The wide motion vector uses a projection to 512 numbers. It is slower to
search, but keeps smaller differences, which recognition needs (app.models.recognition).

The weights were chosen by hand on half of dataset 2's styles, dataset 1, CMU's clips and the
demo library (`tests/bench/test_retrieval.py` has the curve). No number depends on the phase of the
gait at which a clip starts or ends.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import scipy
from numpy.typing import NDArray

from app.analysis.descriptors.frame_features import FEATURES, POSITIONS
from app.motion.frame.body_frame import ANALYSIS_RATE
from app.numerics.arrays import FloatArray, IntArray

DIMENSIONS = 128
WIDE_DIMENSIONS = 512
RIDGE = 1e-2
"""Added to the diagonal of the covariance. So the logarithm of a still feature is finite, and a
feature that moves by less than 0.1 body lengths (or 0.3 body lengths per second) says little: there
it is noise that moves. Of 1e-3, 3e-3, 1e-2 and 3e-2, the last two found the original of 40 clips
with 1 degree of jitter most often by `vector` (.925; the first .900, the second .875). Clean clips
lose .007 of P@20 and .005 of MAP by `fused`."""

COVARIANCE_SCALE = 1 / 20
"""The weight of the logarithm's entries."""

SLOW_SECONDS = 1.0
"""Seconds (standard deviation). Slower changes belong to the mean position, others to movement."""

POSITION_WEIGHT = 0.75
MOVEMENT_WEIGHT = 1.3
DRIFT_WEIGHT = 2.5
"""The weights of mean positions, of movement around them, and of their change, per body length."""

TRAVEL_WEIGHTS = (2.0, 1.0, 1.0)
"""The weights of the mean velocity to the left, up and forward. People walk forward at many
speeds, but sideways only on purpose."""

SWAY_WEIGHT = 0.7
"""The weight of the velocity's standard deviation."""

TURN_SCALE = 0.3
"""Radians per second. Below, a mean yaw rate counts linearly; above, by its logarithm."""

TURNS_WEIGHT = 0.5
"""The weight of the standard deviation of the slow yaw rate, per radian per second."""

SEED = 20111
"""The seed of the projections. If it changes, every stored vector changes."""

VELOCITY, YAW_RATE = slice(78, 81), 81
"""Columns of the frame features, beside POSITIONS."""

DESCRIPTION_LENGTH = 5 * 39 + 3 + 3 + 1 + 1 + FEATURES * (FEATURES + 1) // 2
"""How many numbers describe a motion before the projection: 3606."""


def motion_vector(features: FloatArray) -> FloatArray:
    """(128,) float32 the motion vector of frame features (n, 82) at ANALYSIS_RATE, n >= 1."""
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
    """(203,) the first part, weighted: means, movement, change, order, travel, sway, turning.

    features: (n, 82). The module describes these numbers.
    """
    positions, velocity, yaw = features[:, POSITIONS], features[:, VELOCITY], features[:, YAW_RATE]
    slow = _slowly(positions)
    about = np.sqrt(np.maximum(_slowly(np.square(positions - slow)), 0.0))
    return np.concatenate(
        [
            POSITION_WEIGHT * positions.mean(axis=0),
            MOVEMENT_WEIGHT * about.mean(axis=0),
            DRIFT_WEIGHT * slow.std(axis=0),
            *_first_cosines(positions),
            velocity.mean(axis=0) * TRAVEL_WEIGHTS,
            SWAY_WEIGHT * velocity.std(axis=0),
            [np.arcsinh(yaw.mean() / TURN_SCALE)],
            [TURNS_WEIGHT * _slowly(yaw, SLOW_SECONDS / 2).std()],
        ]
    )


def _slowly(values: FloatArray, seconds: float = SLOW_SECONDS) -> FloatArray:
    """`values` (n, ...) at ANALYSIS_RATE, smoothed; beyond the ends they are constant.

    Three running means over 2 `seconds` have nearly the shape, and the standard deviation, of a
    Gaussian of `seconds`. Their cost does not depend on `seconds`.
    """
    width = 2 * round(seconds * ANALYSIS_RATE) + 1
    for _ in range(3):
        values = scipy.ndimage.uniform_filter1d(values, width, axis=0, mode="nearest")
    return values


def _first_cosines(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Two arrays (d,): how `values` (n, d) differ between start and end, and between both ends
    and the middle."""
    angles = np.pi * (np.arange(len(values)) + 0.5) / len(values)
    first, second = (
        np.sqrt(2.0) * (np.cos(order * angles) @ values) / len(values) for order in (1, 2)
    )
    return first, second


def log_covariance(features: FloatArray) -> FloatArray:
    """(3403,) the upper triangle of log(covariance + RIDGE I), scaled; features: (n, 82).

    Entries off the diagonal are multiplied by sqrt(2). So the Euclidean distance of two results
    is the Frobenius distance of the matrices.
    """
    count = features.shape[1]
    centered = features - features.mean(axis=0)
    covariance = centered.T @ centered / len(features)
    values, vectors = np.linalg.eigh(covariance + RIDGE * np.eye(count))
    # eigenvalues are >= RIDGE but for rounding
    logarithm = (vectors * np.log(np.maximum(values, RIDGE))) @ vectors.T
    upper, weights = _upper_triangle(count)
    return np.asarray((weights * logarithm.ravel()[upper]) * COVARIANCE_SCALE)


@lru_cache(maxsize=4)
def _upper_triangle(count: int) -> tuple[IntArray, FloatArray]:
    """The flat indices of the upper triangle of a square matrix, and 1 or sqrt(2) for each."""
    rows, columns = np.triu_indices(count)
    return rows * count + columns, np.where(rows == columns, 1.0, np.sqrt(2.0))


@lru_cache(maxsize=1)
def _wide_projection() -> NDArray[np.float32]:
    """(3606, 512) in float32, because all of it is read for each clip."""
    return projection(WIDE_DIMENSIONS).astype(np.float32)


@lru_cache(maxsize=1)
def projection(dimensions: int = DIMENSIONS) -> FloatArray:
    """(3606, dimensions) Gaussian numbers of variance 1 / dimensions, always the same ones.

    numpy guarantees that the stream of `RandomState` never changes; that of `Generator` may.
    """
    stream = np.random.RandomState(SEED)
    drawn: FloatArray = stream.standard_normal((DESCRIPTION_LENGTH, dimensions)) / np.sqrt(
        dimensions
    )
    drawn.setflags(write=False)
    return drawn
