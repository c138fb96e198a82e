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

from dataclasses import dataclass

import numpy as np

from app.motion.frame.body_frame import BodyTrack, turned
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray, IntArray

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


@dataclass(frozen=True, slots=True)
class _Parts:
    """w parts of a motion, n frames each, as in `BodyTrack`.

    positions, local: (w, n, 13, 3); origin: (w, n, 3); heading: (w, n).
    """

    positions: FloatArray
    local: FloatArray
    origin: FloatArray
    heading: FloatArray
    body_length: float
    rate: float

    @property
    def frames(self) -> int:
        """The number of frames of each part."""
        return int(self.heading.shape[1])

    @property
    def duration(self) -> float:
        """Seconds of each part."""
        return self.frames / self.rate

    def velocity(self) -> FloatArray:
        """(w, n, 3) the velocity of the hips in the body frame, body lengths per second."""
        steps = np.gradient(self.origin, axis=1) * (self.rate / self.body_length)
        flat = turned(steps.reshape(-1, 1, 3), -self.heading.ravel())
        return flat.reshape(steps.shape)


def movement_signs(track: BodyTrack) -> FloatArray:
    """(44,) the SIGNS of a motion of n >= 2 frames."""
    return np.asarray(signs_of_parts(track, np.zeros(1, dtype=np.int64), track.frames)[0])


def cycle_of(signs: FloatArray) -> tuple[float, float]:
    """How well a cycle repeats (0..1), and its time in seconds, from `signs` (44,)."""
    likeness, lag = signs[[SIGNS.index("cycle"), SIGNS.index("cycle_time")]]
    return float(likeness), float(np.exp(lag)) - SHORT


def signs_of_parts(track: BodyTrack, firsts: IntArray, frames: int) -> FloatArray:
    """(w, 44) the SIGNS of parts of a motion, each as `movement_signs` of the part alone.

    firsts: (w,) the first frame of each part; frames: the length of each, at least 2. Parts are
    computed together, because calls of NumPy for each would take most of the time.
    """
    at = np.asarray(firsts)[:, None] + np.arange(frames)
    parts = _Parts(
        positions=track.positions[at],
        local=track.local[at],
        origin=track.origin[at],
        heading=track.heading[at],
        body_length=track.body_length,
        rate=track.rate,
    )
    speeds = np.linalg.norm(np.gradient(parts.local, axis=1), axis=3) * parts.rate  # (w, n, 13)
    columns = [
        *_turning(parts),
        *_travel(parts),
        *_height(parts),
        *_rhythm(parts),
        *_limbs(parts, speeds),
    ]
    means = _log(speeds[:, :, [SUN_ROLES.index(role) for role in SPEED_ROLES]].mean(axis=1))
    return np.hstack([np.stack(columns, axis=1), means])


def _turning(parts: _Parts) -> list[FloatArray]:
    """The turn from start to end, its range, the mean rate, and the turn to the left."""
    heading = parts.heading
    net = heading[:, -1] - heading[:, 0]
    rate = np.abs(np.diff(heading, axis=1)).sum(axis=1) / parts.duration
    span = heading.max(axis=1) - heading.min(axis=1)
    limited = np.clip(net, -MAX_TURN, MAX_TURN)
    return [np.tanh(np.abs(net) / HALF_TURN), _log(span), np.log(0.3 + rate), limited]


def _travel(parts: _Parts) -> list[FloatArray]:
    """Mean and top speed; the shares forward, to the left and to any side; and straightness."""
    velocity = parts.velocity()
    speed = np.hypot(velocity[..., 0], velocity[..., 2])
    mean = speed.mean(axis=1)
    left, forward = velocity[..., 0].mean(axis=1), velocity[..., 2].mean(axis=1)
    aside = np.abs(velocity[..., 0]).mean(axis=1)
    moved = (parts.origin[:, -1] - parts.origin[:, 0])[:, [0, 2]] / parts.body_length
    straightness = np.hypot(moved[:, 0], moved[:, 1]) / (0.3 + mean * parts.duration)
    shares = [share / (STILL + mean) for share in (forward, left, aside)]
    return [_log(mean), _log(np.quantile(speed, 0.95, axis=1)), *shares, straightness]


def _height(parts: _Parts) -> list[FloatArray]:
    """Height and share of flight; rise and drop of the hips; their median and lowest height."""
    heights = parts.positions[..., 1] / parts.body_length  # (w, n, 13)
    floor = np.quantile(heights.min(axis=2), FLOOR_QUANTILE, axis=1)
    lower_foot = _of(heights, _R.LEFT_FOOT, _R.RIGHT_FOOT).min(axis=2) - floor[:, None]
    hips = _of(heights, _R.HIPS)[:, :, 0]
    low, median, high = np.quantile(hips, (LOW, 0.5, HIGH), axis=1)
    return [
        np.log(0.02 + np.maximum(np.quantile(lower_foot, HIGH, axis=1), 0.0)),
        np.sqrt((lower_foot > IN_AIR).mean(axis=1)),
        np.log(0.03 + high - median),
        np.log(0.03 + median - low),
        median - floor,
        low - floor,
    ]


def _rhythm(parts: _Parts) -> list[FloatArray]:
    """How well a cycle repeats and how long it takes, how many poses there are, and the duration.

    The number of different poses is the exponential of the entropy of the principal components.
    """
    poses = parts.local.reshape(*parts.heading.shape, -1)
    poses = poses - poses.mean(axis=1, keepdims=True)
    likeness, lag = _cycle(poses, parts.rate)
    variances = np.maximum(np.linalg.eigvalsh(poses.transpose(0, 2, 1) @ poses), 0.0)
    shares = variances / np.maximum(variances.sum(axis=1, keepdims=True), 1e-12)
    entropy = -(shares * np.log(np.maximum(shares, 1e-12))).sum(axis=1)
    duration = np.full(len(poses), np.log(parts.duration))
    return [likeness, np.log(SHORT + lag), entropy, duration]


def _cycle(poses: FloatArray, rate: float) -> tuple[FloatArray, FloatArray]:
    """(w,) the largest correlation (0..1) of centered `poses` (w, n, d) with themselves a cycle
    later, and (w,) the time of that cycle, or of several, in seconds; 0 and 0 without one."""
    parts, count = poses.shape[:2]
    first, stop = int(CYCLE[0] * rate), min(int(CYCLE[1] * rate), count - count // MIN_OVERLAP)
    if stop <= first:
        return np.zeros(parts), np.zeros(parts)
    spectrum = np.fft.rfft(poses, 2 * count, axis=1)
    products = np.fft.irfft((spectrum * spectrum.conj()).real.sum(axis=2), 2 * count, axis=1)
    energy = np.cumsum((poses**2).sum(axis=2), axis=1)
    lags = np.arange(first, stop)
    # the energies of the part before the last `lag` frames, and of the part after the first
    before, after = energy[:, count - 1 - lags], energy[:, -1:] - energy[:, lags - 1]
    likenesses = products[:, lags] / np.sqrt(np.maximum(before * after, 1e-18))
    best = np.argmax(likenesses, axis=1)
    found = np.take_along_axis(likenesses, best[:, None], axis=1)[:, 0]
    has_cycle = found > 0.0
    return (
        np.where(has_cycle, np.minimum(found, 1.0), 0.0),
        np.where(has_cycle, lags[best] / rate, 0.0),
    )


def _limbs(parts: _Parts, speeds: FloatArray) -> list[FloatArray]:
    """Speeds and heights of hands and feet, and how far the body leans and spreads."""
    local = parts.local
    hands = _of(speeds, _R.LEFT_HAND, _R.RIGHT_HAND)
    feet = _of(speeds, _R.LEFT_FOOT, _R.RIGHT_FOOT)
    heights = local[..., 1]
    above_neck = _of(heights, _R.LEFT_HAND, _R.RIGHT_HAND) - _of(heights, _R.NECK)
    foot = _of(heights, _R.LEFT_FOOT, _R.RIGHT_FOOT)
    knee = _of(heights, _R.LEFT_KNEE, _R.RIGHT_KNEE)
    neck = _of(local, _R.NECK)[:, :, 0]
    peaks = [_log(np.quantile(pair.max(axis=2), HIGH, axis=1)) for pair in (hands, feet)]
    sides = [np.subtract(*_log(pair.mean(axis=1)).T) for pair in (hands, feet)]
    return [
        _log(hands.mean(axis=(1, 2))),
        _log(feet.mean(axis=(1, 2))),
        *peaks,
        *sides,
        np.quantile(above_neck.max(axis=2), 0.95, axis=1),
        above_neck.max(axis=2).mean(axis=1),
        np.quantile(above_neck.min(axis=2), 0.95, axis=1),
        np.quantile(foot.max(axis=2), HIGH, axis=1) - np.median(foot, axis=(1, 2)),
        np.quantile(knee.max(axis=2), HIGH, axis=1),
        np.quantile(np.hypot(neck[..., 0], neck[..., 2]), 0.95, axis=1),
        neck[..., 2].mean(axis=1),
        _apart(local, _R.LEFT_HAND, _R.RIGHT_HAND, 0.9),
        _apart(local, _R.LEFT_FOOT, _R.RIGHT_FOOT, 0.95),
    ]


def _apart(local: FloatArray, one: JointRole, other: JointRole, quantile: float) -> FloatArray:
    line = _of(local, one)[:, :, 0] - _of(local, other)[:, :, 0]
    return np.asarray(np.quantile(np.linalg.norm(line, axis=2), quantile, axis=1))


def _of(values: FloatArray, *roles: JointRole) -> FloatArray:
    """The columns of `values` (w, n, 13, ...) that belong to `roles`."""
    return values[:, :, [SUN_ROLES.index(role) for role in roles]]


def _log(value: FloatArray) -> FloatArray:
    return np.asarray(np.log(SLOW + value))
