"""When a dance's poses are struck: beats that may drift, and what is done on each.

A beat is struck (a keypose is reached, held and left), passed (the limbs run through a pose
without stopping, or through none), or part of a freeze (a keypose held over the next beat).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.numerics.arrays import FloatArray

RHYTHMS: tuple[tuple[int, ...], ...] = ((1,), (1, 1, 2), (1, 1, 1, 2), (2, 1, 1), (1, 2, 1))
"""Beats from one keypose to the next, repeated."""

HOLD = (0.1, 0.4)
"""Share of a beat, around it, for which a pose is held."""

TIMING = 0.015
"""Seconds (standard deviation) by which dancers miss a beat."""

SOONEST = 0.65
"""Seconds from the first frame to the first beat. A recording does not begin within a movement."""

THROUGH_A_POSE = 0.5
"""How often a passed beat has a pose of its own, through which the limbs run."""


@dataclass(frozen=True, slots=True)
class Moment:
    """A pose in time, s: reached, meant, left. All are the same where it is only passed."""

    beat: int
    arrive: float
    time: float
    leave: float

    @property
    def is_held(self) -> bool:
        """Whether the body comes to rest: a keypose."""
        return self.leave > self.arrive


@dataclass(frozen=True, slots=True)
class Counts:
    """beats: (b,) s, rising; moments: poses held or passed, rising; interval: s, nominal."""

    beats: FloatArray
    moments: tuple[Moment, ...]
    interval: float

    @property
    def held(self) -> tuple[Moment, ...]:
        """The keyposes."""
        return tuple(moment for moment in self.moments if moment.is_held)

    def phase(self, times: FloatArray) -> FloatArray:
        """(frames,) beats since the first one, going on evenly before and after them."""
        at = np.arange(len(self.beats))
        inside = np.interp(times, self.beats, at)
        before = np.minimum(times - self.beats[0], 0.0) / (self.beats[1] - self.beats[0])
        after = np.maximum(times - self.beats[-1], 0.0) / (self.beats[-1] - self.beats[-2])
        return np.asarray(inside + before + after)


def counted(
    draw: np.random.RandomState,
    bpm: float,
    seconds: float,
    *,
    drift: float,
    passes: float,
    freezes: float,
) -> Counts:
    """Beats of about `bpm` for `seconds`, and the moments on them.

    drift: greatest relative departure of the tempo from `bpm`; passes: share of the other
    beats, beyond the rhythm's own, that are passed; freezes: share that is held for longer.
    """
    beats = _beats(draw, bpm, seconds, drift)
    return Counts(beats, tuple(_moments(draw, beats, passes, freezes)), 60.0 / bpm)


def _beats(draw: np.random.RandomState, bpm: float, seconds: float, drift: float) -> FloatArray:
    """Times of beats; the tempo wanders slowly, or changes steadily in one direction."""
    interval = 60.0 / bpm
    count = max(4, int((seconds - interval) / interval))
    at = np.linspace(0.0, 1.0, count)
    turns, start = draw.uniform(0.5, 1.5), draw.uniform(0.0, 2.0 * np.pi)
    steady = draw.choice([-1.0, 1.0]) * (2.0 * at - 1.0)
    course = steady if draw.rand() < 0.4 else np.sin(2.0 * np.pi * turns * at + start)
    intervals = interval * np.exp(drift * course)
    first = max(interval * draw.uniform(0.6, 1.0), SOONEST)
    return np.asarray(first + np.cumsum(intervals) - intervals[0])


def _moments(
    draw: np.random.RandomState, beats: FloatArray, passes: float, freezes: float
) -> list[Moment]:
    rhythm = RHYTHMS[draw.randint(len(RHYTHMS))]
    hold = draw.uniform(*HOLD)
    found: list[Moment] = []
    beat, count = 0, 0
    while beat < len(beats):
        gap = rhythm[count % len(rhythm)] + int(draw.rand() < passes)
        frozen = draw.rand() < freezes and beat + 1 < len(beats)
        gap = max(gap, 2) if frozen else gap
        found.append(_struck(draw, beats, beat, hold, frozen))
        for passed in range(beat + 1 + frozen, min(beat + gap, len(beats))):
            if draw.rand() < THROUGH_A_POSE:
                time = float(beats[passed])
                found.append(Moment(passed, time, time, time))
        beat, count = beat + gap, count + 1
    return _ending_at_rest(found)


def _struck(
    draw: np.random.RandomState, beats: FloatArray, beat: int, hold: float, frozen: bool
) -> Moment:
    near = beats[min(beat, len(beats) - 2) : min(beat, len(beats) - 2) + 2]
    length = float(near[1] - near[0])
    half = 0.5 * hold * draw.uniform(0.7, 1.3) * length
    time = float(beats[beat] + np.clip(TIMING * draw.randn(), -0.04, 0.04))
    return Moment(beat, time - half, time, time + half + (length if frozen else 0.0))


def _ending_at_rest(moments: list[Moment]) -> list[Moment]:
    while not moments[-1].is_held:
        moments.pop()
    return moments
