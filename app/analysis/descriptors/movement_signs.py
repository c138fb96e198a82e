"""Signs of movement: a few measures of a clip that mean the same for any person and any recording.

A turn is a change of heading, a jump has both feet in the air, a dance has many different poses.
Statistics of the motion symbol (app.analysis.symbols.channels) describe a clip in detail, but words
that were learned from them in one source fit clips of another source badly: skeletons, sizes of
movements and habits differ. Signs say less, and carry over. The word model uses both
(app.models.words.model), and words for parts of the body that no clip carries use the speeds of the
joints (app.models.words.body_words).

The source is our own. All signs are computed at ANALYSIS_RATE from the active part of a clip, in
body lengths and seconds; measures without an upper limit are logarithms with a small constant, so
that rest is a finite number.
"""

from __future__ import annotations

import numpy as np

from app.motion.frame.body_frame import BodyTrack
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray

_R = JointRole

SPEED_ROLES = (
    *(_R.LEFT_HAND, _R.RIGHT_HAND, _R.LEFT_ELBOW, _R.RIGHT_ELBOW),
    *(_R.LEFT_FOOT, _R.RIGHT_FOOT, _R.LEFT_KNEE, _R.RIGHT_KNEE, _R.HEAD),
)
"""The joints whose speeds are signs."""

SIGNS: tuple[str, ...] = (
    *("turn", "turn_range", "turn_rate", "turn_to_left"),
    *("speed", "top_speed", "forward", "to_left", "aside", "straightness"),
    *("flight", "flight_share", "rise", "drop", "hip_height", "lowest_hips"),
    *("cycle", "cycle_time", "variety", "duration"),
    *("hand_speed", "foot_speed", "hand_peak", "foot_peak", "hand_side", "foot_side"),
    *("hand_height", "mean_hand_height", "both_hands_height", "foot_height", "knee_height"),
    *("lean", "lean_forward", "hand_spread", "foot_spread"),
    *(f"{role.value}_speed" for role in SPEED_ROLES),
)
"""The names of the signs, in their order."""

LOW, HIGH = 0.02, 0.98
"""The quantiles used as extremes. A single bad frame changes them little."""
FLOOR_QUANTILE = 0.01
"""The lowest joint is below the floor in this share of the frames."""
IN_AIR = 0.1
"""Body lengths of the lower foot above the floor: more than the lift of an ankle in a step."""
HALF_TURN = 1.5
"""Radians of a clear turn, at which the sign `turn` is three quarters of its limit of 1."""
MAX_TURN = 3.0
"""Radians: limit of the sign `turn_to_left`."""
CYCLE = 0.3, 3.0
"""Seconds: bounds of a cycle."""
SHORT = 0.3
"""Seconds: cycle times below it differ little."""
MIN_OVERLAP = 3
"""A cycle is compared with at least one part in this of the clip."""
SLOW = 0.1
"""Body lengths per second: speeds below it differ little."""
STILL = 0.2
"""Body lengths per second: a body that travels more slowly goes nowhere."""


def movement_signs(track: BodyTrack) -> FloatArray:
    """(44,) the SIGNS of a motion of n >= 2 frames."""
    speeds = np.linalg.norm(np.gradient(track.local, axis=0), axis=2) * track.rate  # (n, 13)
    parts = (_turning(track), _travel(track), _height(track), _rhythm(track), _limbs(track, speeds))
    means = _log(speeds[:, [SUN_ROLES.index(role) for role in SPEED_ROLES]].mean(axis=0))
    return np.concatenate([*parts, means])


def cycle_of(signs: FloatArray) -> tuple[float, float]:
    """How well a cycle repeats (0..1), and its time in seconds, from `signs` (44,)."""
    likeness, lag = signs[[SIGNS.index("cycle"), SIGNS.index("cycle_time")]]
    return float(likeness), float(np.exp(lag)) - SHORT


def _turning(track: BodyTrack) -> FloatArray:
    """The turn from start to end, its range, the mean rate, and the turn to the left."""
    heading = track.heading
    net = heading[-1] - heading[0]
    rate = np.abs(np.diff(heading)).sum() / track.duration
    span = heading.max() - heading.min()
    limited = np.clip(net, -MAX_TURN, MAX_TURN)
    return np.array([np.tanh(abs(net) / HALF_TURN), _log(span), np.log(0.3 + rate), limited])


def _travel(track: BodyTrack) -> FloatArray:
    """Mean and top speed; the shares forward, to the left and to any side; and straightness."""
    velocity = track.velocity()
    speed = np.hypot(velocity[:, 0], velocity[:, 2])
    mean = speed.mean()
    left, forward = velocity[:, 0].mean(), velocity[:, 2].mean()
    aside = np.abs(velocity[:, 0]).mean()
    moved = (track.origin[-1] - track.origin[0])[[0, 2]] / track.body_length
    straightness = np.hypot(*moved) / (0.3 + mean * track.duration)
    shares = np.array([forward, left, aside]) / (STILL + mean)
    return np.array([_log(mean), _log(np.quantile(speed, 0.95)), *shares, straightness])


def _height(track: BodyTrack) -> FloatArray:
    """Height and share of flight; rise and drop of the hips; their median and lowest height."""
    heights = track.positions[:, :, 1] / track.body_length
    floor = np.quantile(heights.min(axis=1), FLOOR_QUANTILE)
    lower_foot = _of(heights, _R.LEFT_FOOT, _R.RIGHT_FOOT).min(axis=1) - floor
    hips = _of(heights, _R.HIPS)[:, 0]
    low, median, high = np.quantile(hips, (LOW, 0.5, HIGH))
    return np.array(
        [
            np.log(0.02 + max(float(np.quantile(lower_foot, HIGH)), 0.0)),
            np.sqrt((lower_foot > IN_AIR).mean()),
            np.log(0.03 + high - median),
            np.log(0.03 + median - low),
            median - floor,
            low - floor,
        ]
    )


def _rhythm(track: BodyTrack) -> FloatArray:
    """How well a cycle repeats and how long it takes, how many poses there are, and the duration.

    The number of different poses is the exponential of the entropy of the principal components.
    """
    poses = track.local.reshape(track.frames, -1)
    poses = poses - poses.mean(axis=0)
    likeness, lag = _cycle(poses, track.rate)
    variances = np.maximum(np.linalg.eigvalsh(poses.T @ poses), 0.0)
    shares = variances / max(float(variances.sum()), 1e-12)
    entropy = -(shares * np.log(np.maximum(shares, 1e-12))).sum()
    return np.array([likeness, np.log(SHORT + lag), entropy, np.log(track.duration)])


def _cycle(poses: FloatArray, rate: float) -> tuple[float, float]:
    """The largest correlation (0..1) of centered `poses` (n, d) with themselves a cycle later, and
    the time of that cycle, or of several, in seconds; 0 and 0 for a clip without one."""
    count = len(poses)
    first, stop = int(CYCLE[0] * rate), min(int(CYCLE[1] * rate), count - count // MIN_OVERLAP)
    if stop <= first:
        return 0.0, 0.0
    spectrum = np.fft.rfft(poses, 2 * count, axis=0)
    products = np.fft.irfft((spectrum * spectrum.conj()).sum(axis=1), 2 * count)
    energy = np.cumsum((poses**2).sum(axis=1))
    lags = np.arange(first, stop)
    # the energies of the part before the last `lag` frames, and of the part after the first
    before, after = energy[count - 1 - lags], energy[-1] - energy[lags - 1]
    likenesses = products[lags] / np.sqrt(np.maximum(before * after, 1e-18))
    best = int(np.argmax(likenesses))
    if likenesses[best] <= 0.0:
        return 0.0, 0.0
    return float(min(likenesses[best], 1.0)), float(lags[best] / rate)


def _limbs(track: BodyTrack, speeds: FloatArray) -> FloatArray:
    """Speeds and heights of hands and feet, and how far the body leans and spreads."""
    local = track.local
    hands = _of(speeds, _R.LEFT_HAND, _R.RIGHT_HAND)
    feet = _of(speeds, _R.LEFT_FOOT, _R.RIGHT_FOOT)
    heights = local[:, :, 1]
    above_neck = _of(heights, _R.LEFT_HAND, _R.RIGHT_HAND) - _of(heights, _R.NECK)
    foot = _of(heights, _R.LEFT_FOOT, _R.RIGHT_FOOT)
    knee = _of(heights, _R.LEFT_KNEE, _R.RIGHT_KNEE)
    neck = _of(local, _R.NECK)[:, 0]
    peaks = [_log(np.quantile(pair.max(axis=1), HIGH)) for pair in (hands, feet)]
    sides = [np.subtract(*_log(pair.mean(axis=0))) for pair in (hands, feet)]
    return np.array(
        [
            _log(hands.mean()),
            _log(feet.mean()),
            *peaks,
            *sides,
            np.quantile(above_neck.max(axis=1), 0.95),
            above_neck.max(axis=1).mean(),
            np.quantile(above_neck.min(axis=1), 0.95),
            np.quantile(foot.max(axis=1), HIGH) - np.median(foot),
            np.quantile(knee.max(axis=1), HIGH),
            np.quantile(np.hypot(neck[:, 0], neck[:, 2]), 0.95),
            neck[:, 2].mean(),
            _apart(local, _R.LEFT_HAND, _R.RIGHT_HAND, 0.9),
            _apart(local, _R.LEFT_FOOT, _R.RIGHT_FOOT, 0.95),
        ]
    )


def _apart(local: FloatArray, one: JointRole, other: JointRole, quantile: float) -> float:
    line = _of(local, one)[:, 0] - _of(local, other)[:, 0]
    return float(np.quantile(np.linalg.norm(line, axis=1), quantile))


def _of(values: FloatArray, *roles: JointRole) -> FloatArray:
    """The columns of `values` (n, 13, ...) that belong to `roles`."""
    return values[:, [SUN_ROLES.index(role) for role in roles]]


def _log(value: FloatArray | float) -> FloatArray:
    return np.asarray(np.log(SLOW + np.asarray(value)))
