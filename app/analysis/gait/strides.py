"""Strides: from one strike of a foot to the next strike of the same foot, with their parameters.

Lengths are those between the places of the ankles at their strikes. The line of progress of a
stride goes from the place of the foot at the first strike to its place at the second one, as on a
pressure-sensitive walkway. So a walk may turn.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from app.analysis.gait.events import MAX_STRIDE_TIME, MIN_STRIDE_TIME, FootEvents, foot_events
from app.analysis.gait.walk import SIDES, Walk
from app.errors import NoGait
from app.kinedex_error import Place
from app.numerics.arrays import FloatArray

MIN_STRIDE_LENGTH = 0.3
"""Leg lengths. Shorter ones are steps on the spot."""

MAX_SLIDE = 0.5
"""The largest speed of a foot in the middle of its stance, as a share of the speed of the walk. In
real walks it is near 0; kicks and dances have no foot that stands while the body moves over it."""

MIN_TRAVEL = 0.7
"""The share of the stride's length that the hips travel in the same time, at least."""

SAMPLES = 50
"""The number of times of a stride that distinguish a run from a walk."""

MIN_BOUNCE = 0.05
"""Leg lengths: the hips of a run rise and fall at least so far."""

MIN_CORRELATION = 0.2
"""Of the distance between the feet and the height of the hips: above it, a stride is a run. So 94 %
of 280 real strides of runs are runs, and 1 % of 1,424 strides of walks (CMU, Bandai-Namco)."""

STANDING_PART = (0.3, 0.6)
"""The part of the stance in which the whole foot stands."""


@dataclass(frozen=True, slots=True)
class Stride:
    """One stride of one side. Times are seconds of the clip.

    strike, next_strike: of this foot. off: when this foot leaves the floor. other_strike,
    other_off: those of the other foot in between. length, step_length, step_width: meters.
    heading: radians about the vertical, from +Z toward +X: the direction of the stride. is_run: a
    run has flight phases, and the method does not find when a running foot leaves the floor.
    """

    side: str
    strike: float
    off: float
    next_strike: float
    other_strike: float
    other_off: float
    length: float
    step_length: float
    step_width: float
    heading: float
    is_run: bool

    @property
    def time(self) -> float:
        """Seconds."""
        return self.next_strike - self.strike

    @property
    def step_time(self) -> float:
        """Seconds from the other foot's strike to the strike of this foot that ends the stride."""
        return self.next_strike - self.other_strike

    @property
    def stance_time(self) -> float:
        """Seconds in which this foot is on the floor."""
        return self.off - self.strike

    @property
    def double_support_time(self) -> float:
        """Seconds in which both feet are on the floor; 0 in a run."""
        first = max(0.0, self.other_off - self.strike) if self.other_off < self.other_strike else 0
        return first + max(0.0, self.off - self.other_strike)


def strides_of(walk: Walk) -> tuple[Stride, ...]:
    """The strides of both sides in the order of time.

    Raises NoGait if there is none: it says what is missing.
    """
    events = foot_events(walk)
    found = [stride for side in SIDES for stride in _of_side(walk, events, side)]
    if not found:
        raise _no_gait(walk, events)
    return tuple(sorted(found, key=lambda stride: stride.strike))


def _of_side(walk: Walk, events: Mapping[str, FootEvents], side: str) -> list[Stride]:
    own, other = events[side], events[_other(side)]
    found = []
    for strike, next_strike in pairwise(own.strikes.tolist()):
        if not MIN_STRIDE_TIME <= next_strike - strike <= MAX_STRIDE_TIME:
            continue
        inside = [_between(times, strike, next_strike) for times in _three(own, other)]
        if any(len(times) != 1 for times in inside):
            continue
        off, other_strike, other_off = (float(times[0]) for times in inside)
        times = (strike, off, next_strike, other_strike, other_off)
        stride = _stride(walk, side, times)
        is_long = stride.length >= MIN_STRIDE_LENGTH * walk.leg_length
        if is_long and _travels(walk, stride) and _stands(walk, stride):
            found.append(stride)
    return found


def _other(side: str) -> str:
    return SIDES[1 - SIDES.index(side)]


def _three(own: FootEvents, other: FootEvents) -> tuple[FloatArray, FloatArray, FloatArray]:
    return own.offs, other.strikes, other.offs


def _between(times: FloatArray, first: float, last: float) -> FloatArray:
    return times[(times > first) & (times < last)]


def _stride(walk: Walk, side: str, times: tuple[float, float, float, float, float]) -> Stride:
    strike, off, next_strike, other_strike, other_off = times
    here, there = walk.on_floor(walk.ankles[side], np.array([strike, next_strike]))
    (other,) = walk.on_floor(walk.ankles[_other(side)], np.array([other_strike]))
    line = there - here
    length = float(np.linalg.norm(line))
    ahead = line / max(length, 1e-9)
    return Stride(
        side=side,
        strike=strike,
        off=off,
        next_strike=next_strike,
        other_strike=other_strike,
        other_off=other_off,
        length=length,
        step_length=float((there - other) @ ahead),
        step_width=_width(walk, side, times, ahead),
        is_run=_is_run(walk, strike, next_strike),
        heading=float(np.arctan2(ahead[0], ahead[1])),
    )


def _width(
    walk: Walk, side: str, times: tuple[float, float, float, float, float], ahead: FloatArray
) -> float:
    """Meters from the line of progress to the other foot; negative if the feet cross."""
    strike, _, next_strike, other_strike, _ = times
    (here,) = walk.on_floor(walk.ankles[side], np.array([strike]))
    (other,) = walk.on_floor(walk.ankles[_other(side)], np.array([other_strike]))
    across = np.array([ahead[1], -ahead[0]])
    first, last = (round((time - walk.start) * walk.rate) for time in (strike, next_strike))
    # a person who walks backward has the left leg on the other side of the line
    across = across * np.sign(walk.leftward[first : last + 1].mean(axis=0) @ across)
    return float((here - other) @ across) * (1.0 if side == "left" else -1.0)


def _is_run(walk: Walk, strike: float, next_strike: float) -> bool:
    """Whether the hips are high while the feet are apart. In a walk they are low then: they pass
    high over the standing leg."""
    times = np.linspace(strike, next_strike, SAMPLES)
    apart, height = walk.apart(times), walk.at(walk.hips[:, 1], times)
    if np.ptp(height) < MIN_BOUNCE * walk.leg_length:
        return False
    return bool(np.corrcoef(apart, height)[0, 1] > MIN_CORRELATION)


def _travels(walk: Walk, stride: Stride) -> bool:
    """Whether the hips go with the foot. In a step forward and back they do not."""
    start, end = walk.on_floor(walk.hips, np.array([stride.strike, stride.next_strike]))
    return float(np.linalg.norm(end - start)) >= MIN_TRAVEL * stride.length


def _stands(walk: Walk, stride: Stride) -> bool:
    """Whether the foot stands in the middle of its stance while the body moves on."""
    span = [stride.strike + share * stride.stance_time for share in STANDING_PART]
    (start, end) = walk.on_floor(walk.ankles[stride.side], np.array(span))
    speed = float(np.linalg.norm(end - start)) / (span[1] - span[0])
    return speed <= MAX_SLIDE * stride.length / stride.time


def _no_gait(walk: Walk, events: Mapping[str, FootEvents]) -> NoGait:
    counts = ", ".join(f"{len(events[side].strikes)} strikes of the {side} foot" for side in SIDES)
    travel = float(np.ptp(walk.hips, axis=0).max()) if len(walk.hips) else 0.0
    message = (
        "expected at least one stride (two strikes of one foot, with a step of the other one "
        f"between, {MIN_STRIDE_LENGTH * walk.leg_length:.2f} m apart or more, and the foot stands "
        f"while the hips pass over it), found {counts}; the hips travel {travel:.1f} m"
    )
    return NoGait(
        f"The clip has no walking: {message}.", places=[Place("clip_id", "has no walking")]
    )
