"""The features of each frame. They do not depend on position, heading, size, unit and frame rate.

82 features at 30 Hz: positions of Sun's 13 joints in the body frame (39, body lengths),
their velocities (39, change in 1/3 s, halved), the hips' velocity in the body frame
(3, body lengths per s) and the yaw rate (1, radians per s).
"""

from __future__ import annotations

import numpy as np

from app.motion.frame.body_frame import BodyTrack
from app.motion.skeleton.resampling import resample
from app.numerics.arrays import FloatArray
from app.numerics.differences import central_differences

FEATURES = 82
VELOCITY_STEP = 1 / 3
"""Seconds. A velocity is given as the change in this time."""

VELOCITY_WEIGHT = 0.5
"""The weight of the joints' velocities; their positions have weight 1."""

WARPING_RATE = 10.0
"""Hz: the rate at which motions are warped onto each other."""

TRAVEL_WEIGHT = 2.0
"""The weight of the hips' velocity and the yaw rate in warping."""

POSITIONS = slice(0, 39)
"""The columns of the positions of the 13 joints in the body frame, in body lengths."""

TRAVEL = slice(78, 82)
"""The columns of the hips' velocity and the yaw rate."""


def frame_features(track: BodyTrack) -> FloatArray:
    """(n, 82) float64 features of each frame of `track`, in the order and units of the module."""
    positions = track.local.reshape(track.frames, -1)
    changes = central_differences(positions)
    changes *= track.rate * VELOCITY_STEP * VELOCITY_WEIGHT
    return np.hstack([positions, changes, track.velocity(), track.yaw_rate()[:, None]])


def features_at_10hz(features: FloatArray, rate: float) -> FloatArray:
    """(m, 82) float32: `features` (n, 82) of `rate` Hz, resampled to WARPING_RATE for warping.

    The columns of TRAVEL are multiplied by TRAVEL_WEIGHT. The Euclidean distance of two rows is
    the cost of matching them.
    """
    slow = resample(features, rate, WARPING_RATE)
    slow[:, TRAVEL] *= TRAVEL_WEIGHT
    return slow.astype(np.float32)
