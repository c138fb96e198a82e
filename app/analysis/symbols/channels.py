"""The 26 channels of a motion symbol (Takano, section 3).

The paper uses 20 joint angles; height, roll and pitch of the trunk; two horizontal speeds; and the
yaw rate. Many formats have no usable rotations, and joint angles of different skeletons do not
agree. So we compute 20 channels from the positions of joint roles: the directions of upper arms and
thighs in the body frame (three cosines each, which do not jump as an angle does at +-180 degrees),
the flexion of elbows and knees, the rise of the forearms, and the lean of the head. Nothing is
fitted, so the channels of all libraries can be compared.
"""

from __future__ import annotations

import numpy as np

from app.motion.frame.body_frame import BodyTrack
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray, IntArray
from app.numerics.quantiles import quantile, quantiles_of_sorted

_R = JointRole

CHANNELS: tuple[str, ...] = (
    *(f"{side}_thigh_{axis}" for side in ("left", "right") for axis in ("left", "up", "forward")),
    "left_knee_flexion",
    "right_knee_flexion",
    *(f"{side}_arm_{axis}" for side in ("left", "right") for axis in ("left", "up", "forward")),
    "left_elbow_flexion",
    "right_elbow_flexion",
    "left_forearm_up",
    "right_forearm_up",
    "head_left",
    "head_forward",
    "height",
    "roll",
    "pitch",
    "speed_left",
    "speed_forward",
    "yaw_rate",
)
"""The names of the channels, in their order."""

_THIGH_AND_ARM = (0.15, 0.15, 0.25), (0.3, 0.5, 0.4)

CHANNEL_SCALES: FloatArray = np.array(
    [
        *_THIGH_AND_ARM[0],
        *_THIGH_AND_ARM[0],
        *(0.15, 0.15),  # knees
        *_THIGH_AND_ARM[1],
        *_THIGH_AND_ARM[1],
        *(0.25, 0.25),  # elbows
        *(0.65, 0.65),  # forearms
        *(0.15, 0.25),  # head
        *(0.12, 0.08, 0.18),  # height, roll, pitch
        *(0.3, 0.9, 1.3),  # speeds, yaw rate
    ]
)
"""The typical standard deviation of each channel over varied motion, in its unit (cosine, radian,
body length, body lengths / s, radians / s). It was measured once on CMU and Bandai Namco clips and
rounded. It is part of the descriptor's definition and is never fitted again."""

EXTREMES = (0.02, 0.98)
"""The quantiles used as extremes of a channel. A single bad frame changes them little."""

MAX_YAW_RATE = 10.0
"""Radians per second. The channel saturates there, for example in a roll or a fall."""

FLOOR_QUANTILE = 0.01
"""The lowest joint is below the floor in this share of the frames."""

MIN_LIMB_LENGTH = 0.02
"""Body lengths. The direction of a shorter limb, whose joint may be missing, goes to zero."""


def symbol_features(track: BodyTrack) -> FloatArray:
    """(n, 26) the channels at ANALYSIS_RATE, each divided by its scale in CHANNEL_SCALES.

    They do not depend on the place, the heading, the size or the unit of the body.
    """
    limbs = _limb_channels(track.local)
    trunk = _trunk_channels(track)
    return np.asarray(np.hstack([limbs, trunk]) / CHANNEL_SCALES)


def symbol_statistics(features: FloatArray, rate: float) -> FloatArray:
    """(131,) the statistics of `features` (n, 26) at `rate` Hz that the word model uses.

    For each channel these are the mean, the standard deviation, the mean absolute change per
    second, and the low and the high quantile (EXTREMES). The last number is the logarithm of the
    length in seconds. On 496 held-out real clips, the quantiles add .013 to top-3 recognition,
    .008 to F and .010 to MAP (three foldings).
    """
    whole = np.zeros(1, dtype=np.int64)
    return np.asarray(statistics_of_parts(features, rate, whole, len(features))[0])


def statistics_of_parts(
    features: FloatArray, rate: float, firsts: IntArray, frames: int
) -> FloatArray:
    """(w, 131) the `symbol_statistics` of parts of `features` (N, 26), each of `frames` frames.

    firsts: (w,) the first frame of each part.
    """
    rows = np.ascontiguousarray(features.T)
    values = rows[:, firsts[:, None] + np.arange(frames)]  # (26, w, n)
    # The mean of the changes inside of a part, from their running sum.
    path = np.cumsum(np.abs(np.diff(rows, axis=1, prepend=rows[:, :1])), axis=1)
    steps = path[:, firsts + frames - 1] - path[:, firsts]
    ordered = np.sort(values, axis=2)
    low, high = (quantiles_of_sorted(ordered, np.full(len(ordered), share)) for share in EXTREMES)
    found = [
        values.mean(axis=2),
        values.std(axis=2),
        steps * (rate / max(frames - 1, 1)),
        low,
        high,
    ]
    seconds = np.full((1, len(firsts)), np.log(frames / rate))
    return np.asarray(np.vstack([*found, seconds]).T)


def _limb_channels(local: FloatArray) -> FloatArray:
    """(n, 20) the channels of the limbs and the head, of body-frame positions (n, 13, 3)."""
    thighs = _direction(local, _R.HIPS, _R.LEFT_KNEE), _direction(local, _R.HIPS, _R.RIGHT_KNEE)
    shins = (
        _direction(local, _R.LEFT_KNEE, _R.LEFT_FOOT),
        _direction(local, _R.RIGHT_KNEE, _R.RIGHT_FOOT),
    )
    arms = (
        _direction(local, _R.LEFT_SHOULDER, _R.LEFT_ELBOW),
        _direction(local, _R.RIGHT_SHOULDER, _R.RIGHT_ELBOW),
    )
    forearms = (
        _direction(local, _R.LEFT_ELBOW, _R.LEFT_HAND),
        _direction(local, _R.RIGHT_ELBOW, _R.RIGHT_HAND),
    )
    columns = [
        *thighs,
        *(_flexion(upper, lower) for upper, lower in zip(thighs, shins, strict=True)),
        *arms,
        *(_flexion(upper, lower) for upper, lower in zip(arms, forearms, strict=True)),
        *(forearm[:, 1:2] for forearm in forearms),
        _direction(local, _R.NECK, _R.HEAD)[:, [0, 2]],
    ]
    return np.hstack(columns)


def _trunk_channels(track: BodyTrack) -> FloatArray:
    """(n, 6) height (body lengths), roll and pitch (cosines), two speeds, and yaw rate."""
    spine = _direction(track.local, _R.HIPS, _R.NECK)
    velocity = track.velocity()
    yaw_rate = MAX_YAW_RATE * np.tanh(track.yaw_rate() / MAX_YAW_RATE)
    posture = [_height(track), spine[:, 0], spine[:, 2]]
    return np.stack([*posture, velocity[:, 0], velocity[:, 2], yaw_rate], axis=1)


def _height(track: BodyTrack) -> FloatArray:
    """(n,) the height of the hips above the floor of the clip, body lengths."""
    lowest = track.positions[:, :, 1].min(axis=1)
    floor = quantile(lowest, FLOOR_QUANTILE)
    return np.asarray((track.origin[:, 1] - floor) / track.body_length)


def _direction(local: FloatArray, start: JointRole, end: JointRole) -> FloatArray:
    """(n, 3) the unit vector from one joint to another; it is shorter below MIN_LIMB_LENGTH."""
    line = local[:, SUN_ROLES.index(end)] - local[:, SUN_ROLES.index(start)]
    length = np.linalg.norm(line, axis=1, keepdims=True)
    return np.asarray(line / np.maximum(length, MIN_LIMB_LENGTH))


def _flexion(upper: FloatArray, lower: FloatArray) -> FloatArray:
    """(n, 1) half the chord between the directions of two limbs: 0 if straight, 1 if folded.

    This is the sine of half the angle. It is smooth at a straight limb, where the angle is not.
    """
    return np.asarray(np.linalg.norm(upper - lower, axis=1, keepdims=True) / 2.0)
