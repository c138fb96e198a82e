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

from collections.abc import Mapping

import numpy as np
import scipy

from app.analysis.descriptors.sign_series import ROWS, SPEED_ROLES, Parts, SignSeries
from app.motion.frame.body_frame import BodyTrack
from app.numerics.arrays import FloatArray, IntArray
from app.numerics.quantiles import median, quantiles_of_sorted

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


_FASTER = {
    "fast_hand": ("left_hand_speed", "right_hand_speed"),
    "fast_foot": ("left_foot_speed", "right_foot_speed"),
}
"""The rows of which the larger one in each frame is looked at."""

_EXTREMES = {
    "top_speed": ("speed", 0.95),
    "floor": ("lowest", FLOOR_QUANTILE),
    "flight": ("lower_foot", HIGH),
    "low_hips": ("hips", LOW),
    "middle_hips": ("hips", 0.5),
    "high_hips": ("hips", HIGH),
    "hand_peak": ("fast_hand", HIGH),
    "foot_peak": ("fast_foot", HIGH),
    "hand_height": ("higher_hand", 0.95),
    "both_hands_height": ("lower_hand", 0.95),
    "foot_height": ("higher_foot", HIGH),
    "knee_height": ("higher_knee", HIGH),
    "lean": ("lean", 0.95),
    "hand_spread": ("hands_apart", 0.9),
    "foot_spread": ("feet_apart", 0.95),
}
"""The row and the share of each quantile over the frames of a part."""


def movement_signs(track: BodyTrack) -> FloatArray:
    """(44,) the SIGNS of a motion of n >= 2 frames."""
    whole = np.zeros(1, dtype=np.int64)
    return np.asarray(signs_of_parts(SignSeries(track), whole, track.frames)[0])


def cycle_of(signs: FloatArray) -> tuple[float, float]:
    """How well a cycle repeats (0..1), and its time in seconds, from `signs` (44,)."""
    likeness, lag = signs[[SIGNS.index("cycle"), SIGNS.index("cycle_time")]]
    return float(likeness), float(np.exp(lag)) - SHORT


def signs_of_parts(series: SignSeries, firsts: IntArray, frames: int) -> FloatArray:
    """(w, 44) the SIGNS of parts of a motion, each as `movement_signs` of the part alone.

    firsts: (w,) the first frame of each part; frames: the length of each, at least 2. Parts are
    computed together, because calls of NumPy for each would take most of the time.
    """
    parts = series.of_parts(np.asarray(firsts), frames)
    means = dict(zip(ROWS, parts.rows.mean(axis=2), strict=True))
    extremes = _extremes(parts)
    columns = [
        *_turning(parts),
        *_travel(parts, means, extremes),
        *_height(parts, extremes),
        *_rhythm(parts),
        *_limbs(parts, means, extremes),
        *(_log(means[f"{role.value}_speed"]) for role in SPEED_ROLES),
    ]
    return np.stack(columns, axis=1)


def _extremes(parts: Parts) -> dict[str, FloatArray]:
    """The quantiles (w,) of _EXTREMES, by name. All are read from one array of sorted rows."""
    rows = list(dict.fromkeys(row for row, _ in _EXTREMES.values()))
    ordered = np.sort([_row(parts, row) for row in rows], axis=2)
    places = [rows.index(row) for row, _ in _EXTREMES.values()]
    shares = np.array([share for _, share in _EXTREMES.values()])
    return dict(zip(_EXTREMES, quantiles_of_sorted(ordered[places], shares), strict=True))


def _row(parts: Parts, name: str) -> FloatArray:
    """(w, n) a row of `parts`; or the speed of the body, or of the faster hand or foot."""
    if name == "speed":
        return np.asarray(np.hypot(parts["to_left"], parts["forward"]))
    if name in _FASTER:
        one, other = _FASTER[name]
        return np.asarray(np.maximum(parts[one], parts[other]))
    return parts[name]


def _turning(parts: Parts) -> list[FloatArray]:
    """The turn from start to end, its range, the mean rate, and the turn to the left."""
    heading = parts["heading"]
    net = heading[:, -1] - heading[:, 0]
    rate = np.abs(np.diff(heading, axis=1)).sum(axis=1) / parts.duration
    span = heading.max(axis=1) - heading.min(axis=1)
    limited = np.clip(net, -MAX_TURN, MAX_TURN)
    return [np.tanh(np.abs(net) / HALF_TURN), _log(span), np.log(0.3 + rate), limited]


def _travel(
    parts: Parts, means: Mapping[str, FloatArray], extremes: Mapping[str, FloatArray]
) -> list[FloatArray]:
    """Mean and top speed; the shares forward, to the left and to any side; and straightness."""
    mean = _row(parts, "speed").mean(axis=1)
    aside = np.abs(parts["to_left"]).mean(axis=1)
    straightness = parts.way / (0.3 + mean * parts.duration)
    shares = [share / (STILL + mean) for share in (means["forward"], means["to_left"], aside)]
    return [_log(mean), _log(extremes["top_speed"]), *shares, straightness]


def _height(parts: Parts, extremes: Mapping[str, FloatArray]) -> list[FloatArray]:
    """Height and share of flight; rise and drop of the hips; their median and lowest height."""
    floor = extremes["floor"]
    low, median, high = (extremes[name] for name in ("low_hips", "middle_hips", "high_hips"))
    in_air = parts["lower_foot"] - floor[:, None] > IN_AIR
    return [
        np.log(0.02 + np.maximum(extremes["flight"] - floor, 0.0)),
        np.sqrt(in_air.mean(axis=1)),
        np.log(0.03 + high - median),
        np.log(0.03 + median - low),
        median - floor,
        low - floor,
    ]


def _rhythm(parts: Parts) -> list[FloatArray]:
    """How well a cycle repeats and how long it takes, how many poses there are, and the duration.

    The number of different poses is the exponential of the entropy of the principal components.
    """
    poses = parts.poses - parts.poses.mean(axis=2, keepdims=True)
    likeness, lag = _cycle(poses, parts.rate)
    by_part = poses.transpose(1, 0, 2)
    variances = np.maximum(np.linalg.eigvalsh(by_part @ by_part.transpose(0, 2, 1)), 0.0)
    shares = variances / np.maximum(variances.sum(axis=1, keepdims=True), 1e-12)
    entropy = -(shares * np.log(np.maximum(shares, 1e-12))).sum(axis=1)
    duration = np.full(len(by_part), np.log(parts.duration))
    return [likeness, np.log(SHORT + lag), entropy, duration]


def _cycle(poses: FloatArray, rate: float) -> tuple[FloatArray, FloatArray]:
    """(w,) the largest correlation (0..1) of centered `poses` (d, w, n) with themselves a cycle
    later, and (w,) the time of that cycle, or of several, in seconds; 0 and 0 without one."""
    parts, count = poses.shape[1:]
    first, stop = int(CYCLE[0] * rate), min(int(CYCLE[1] * rate), count - count // MIN_OVERLAP)
    if stop <= first:
        return np.zeros(parts), np.zeros(parts)
    length = scipy.fft.next_fast_len(count + stop, real=True)  # no lag reaches around
    spectrum = np.fft.rfft(poses, length, axis=2)
    products = np.fft.irfft((spectrum.real**2 + spectrum.imag**2).sum(axis=0), length, axis=1)
    energy = np.cumsum((poses**2).sum(axis=0), axis=1)
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


def _limbs(
    parts: Parts, means: Mapping[str, FloatArray], extremes: Mapping[str, FloatArray]
) -> list[FloatArray]:
    """Speeds and heights of hands and feet, and how far the body leans and spreads."""
    hands, feet = ([means[row] for row in _FASTER[pair]] for pair in ("fast_hand", "fast_foot"))
    both_feet = np.concatenate([parts["left_foot"], parts["right_foot"]], axis=1)
    return [
        _log((hands[0] + hands[1]) / 2),
        _log((feet[0] + feet[1]) / 2),
        _log(extremes["hand_peak"]),
        _log(extremes["foot_peak"]),
        *(_log(left) - _log(right) for left, right in (hands, feet)),
        extremes["hand_height"],
        means["higher_hand"],
        extremes["both_hands_height"],
        extremes["foot_height"] - median(both_feet.T),
        *(extremes[name] for name in ("knee_height", "lean")),
        means["lean_forward"],
        *(extremes[name] for name in ("hand_spread", "foot_spread")),
    ]


def _log(value: FloatArray) -> FloatArray:
    return np.asarray(np.log(SLOW + value))
