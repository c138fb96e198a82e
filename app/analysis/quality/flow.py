"""How a motion flows: smoothness, loops, rests at its ends, way and turns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from app.motion.frame.body_frame import BodyTrack
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.euclidean import squared_distances
from app.numerics.quantiles import median

WINDOW = 1.0
"""Seconds of a window whose jerk is measured. In longer ones the jerk grows with the length."""

MIN_SECONDS = 0.3
"""Seconds of the shortest clip with a jerk."""

MIN_PEAK = 0.1
"""Body lengths per second: a smaller peak speed counts as this, so that a rest is no jitter."""

LEAST_JERK = 1e-6
"""A smaller dimensionless jerk counts as this: no logarithm of 0."""

ENDS = tuple(
    SUN_ROLES.index(role)
    for role in (
        *(JointRole.LEFT_HAND, JointRole.RIGHT_HAND, JointRole.LEFT_FOOT, JointRole.RIGHT_FOOT),
        JointRole.HEAD,
    )
)
"""The joints whose jerk is measured."""

MIN_LOOP, MIN_LOOP_SHARE = 0.5, 0.25
"""Seconds and share of the clip that a loop lasts at least."""

MAX_SAMPLES = 240
"""Samples between which loops are looked for, since the work grows with their square."""

LOOP_VELOCITY = 0.1
"""Seconds: the weight of velocities beside positions in the gap of a loop."""

END_SECONDS = 0.2
"""Seconds at each end in which a clip may rest."""

SMOOTHING = 0.1
"""Seconds (standard deviation) by which the heading is smoothed: people who walk sway."""


@dataclass(frozen=True, slots=True)
class Loop:
    """gap: body lengths, see `definitions`. start, end: seconds."""

    gap: float
    start: float
    end: float


def jitter(track: BodyTrack) -> float | None:
    """The log dimensionless jerk of a track without smoothing; None below .3 s.

    Shorter clips than a window have one, of their length, and the jerk is scaled to a window.
    """
    ends = (track.positions[:, ENDS] - track.origin[:1, None]) / track.body_length
    width = min(round(WINDOW * track.rate), track.frames)
    if width < MIN_SECONDS * track.rate:
        return None
    jerks = np.square(np.diff(ends, 3, axis=0) * track.rate**3).sum(axis=-1)  # (n - 3, 5)
    speeds = np.linalg.norm(np.diff(ends, axis=0), axis=-1) * track.rate  # (n - 1, 5)
    starts = np.arange(0, track.frames - width + 1, max(width // 2, 1))
    # (w, 5) the sums of the squared jerks of each window, from running sums
    sums = np.concatenate([np.zeros((1, len(ENDS))), np.cumsum(jerks, axis=0)])
    jerk = (sums[starts + width - 3] - sums[starts]) / (width - 3) * WINDOW
    peak = np.maximum(speeds[starts[:, None] + np.arange(width - 1)].max(axis=1), MIN_PEAK)
    logs = np.log(np.maximum(WINDOW**3 * jerk / peak**2, LEAST_JERK))
    return float(median(logs.mean(axis=1)))


def best_loop(track: BodyTrack) -> Loop | None:
    """The best loop of a smoothed track; None for one that is too short."""
    step = max(1, -(-track.frames // MAX_SAMPLES))
    shortest = max(MIN_LOOP, MIN_LOOP_SHARE * track.duration)
    apart = int(np.ceil(shortest * track.rate / step))
    moves = np.gradient(track.local, axis=0) * track.rate * LOOP_VELOCITY
    states = np.concatenate([track.local, moves], axis=1)[::step]
    states = states.reshape(len(states), -1)
    if len(states) <= apart:
        return None
    costs = squared_distances(states, states, np.square(states).sum(axis=1))
    costs[np.subtract.outer(np.arange(len(costs)), np.arange(len(costs))) > -apart] = np.inf
    start, end = np.unravel_index(int(np.argmin(costs)), costs.shape)
    gap = float(np.sqrt(max(float(costs[start, end]), 0.0) / len(SUN_ROLES)))
    return Loop(gap, float(start * step / track.rate), float(end * step / track.rate))


def end_speeds(track: BodyTrack) -> tuple[float, float]:
    """The root mean square speed of the joints at the start and at the end, body lengths/s."""
    some = min(max(2, round(END_SECONDS * track.rate)), track.frames)
    return _speed(track, slice(0, some)), _speed(track, slice(track.frames - some, track.frames))


def _speed(track: BodyTrack, part: slice) -> float:
    moves = np.diff(track.positions[part], axis=0) * (track.rate / track.body_length)
    return float(np.sqrt(np.square(moves).sum(axis=-1).mean()))


def turns(track: BodyTrack) -> tuple[float, float]:
    """Degrees: the sum of all turns to both sides, and the turn from start to end."""
    heading = scipy.ndimage.gaussian_filter1d(track.heading, SMOOTHING * track.rate, mode="nearest")
    turned = np.abs(np.diff(heading)).sum()
    return float(np.degrees(turned)), float(np.degrees(track.heading[-1] - track.heading[0]))
