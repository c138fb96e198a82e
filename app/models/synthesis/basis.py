"""The weights of the numbers of a motion shape, and their division into parts of the body."""

from __future__ import annotations

import numpy as np

from app.analysis.descriptors.motion_sample import SAMPLES
from app.analysis.descriptors.motion_shape import CHANNELS
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray, IntArray

VELOCITY_WEIGHT = 0.3
YAW_WEIGHT = 0.2
"""Weights of velocities (body lengths per second) and of yaw (radians per second). Positions (body
lengths) have the weight 1."""

_R = JointRole
_PARTS = (
    (_R.LEFT_KNEE, _R.LEFT_FOOT),
    (_R.RIGHT_KNEE, _R.RIGHT_FOOT),
    (_R.HIPS, _R.NECK, _R.HEAD, _R.LEFT_SHOULDER, _R.RIGHT_SHOULDER),
    (_R.LEFT_ELBOW, _R.LEFT_HAND),
    (_R.RIGHT_ELBOW, _R.RIGHT_HAND),
)


def weights() -> FloatArray:
    """(1378,) the weight of each number of a motion shape."""
    channel = np.ones(CHANNELS)
    # channels: 0..38 joints, 39 height, 40 and 41 velocity over the ground, 42 yaw velocity
    channel[40:42], channel[42] = VELOCITY_WEIGHT, YAW_WEIGHT
    return np.concatenate([np.tile(channel, SAMPLES), [1.0, 1.0]])


def parts() -> list[IntArray]:
    """Indices into a motion shape by part: two legs, the trunk, two arms, path with duration."""
    index = np.arange(SAMPLES * CHANNELS).reshape(SAMPLES, CHANNELS)
    parts: list[IntArray] = []
    for roles in _PARTS:
        first = 3 * np.array([SUN_ROLES.index(role) for role in roles])
        columns = (first[:, None] + np.arange(3)).ravel()
        parts.append(index[:, columns].ravel())
    path = index[:, 39:].ravel()
    parts.append(np.concatenate([path, SAMPLES * CHANNELS + np.arange(2)]))
    return parts
