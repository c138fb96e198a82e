"""The beats of a dance, whose tempo may drift, and the poses on them.

On a beat, a keypose is reached, held and left; or the body only slows down at it; or the limbs move
through a pose without a stop; or there is no pose; or a freeze goes on (a keypose that is held over
the next beat).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from app.numerics.arrays import FloatArray

RHYTHMS: tuple[tuple[int, ...], ...] = ((1,), (1, 1, 2), (1, 1, 1, 2), (2, 1, 1), (1, 2, 1))
"""The numbers of beats from one keypose to the next. Each rhythm is repeated."""

TIMING_ERROR = 0.015
"""Seconds (standard deviation) by which dancers miss a beat."""

MAX_TIMING_ERROR = 0.04
"""Seconds."""

MIN_FIRST_BEAT = 0.65
"""The smallest time from the first frame to the first beat, in seconds.

So a recording does not begin within a movement.
"""

PASSING_POSE_PROBABILITY = 0.5
"""The probability that the limbs move through a pose on a beat without a stop."""


@dataclass(frozen=True, slots=True)
class Manner:
    """How somebody dances. All shares are 0..1.

    hold: the range of the share of a beat interval for which a pose is held, centered on the beat.
    passes: the share of keyposes after which an additional beat has no stop. freezes: the share
    of keyposes that are held longer. soft: the share of keyposes at which the body only slows
    down. speed: the range of the share of its speed that is left there. accents: the share of
    passed poses on which the dancer hits the beat. ornaments: factor on the number and size of
    small movements.
    """

    hold: tuple[float, float] = (0.1, 0.4)
    passes: float = 0.15
    freezes: float = 0.04
    soft: float = 0.0
    speed: tuple[float, float] = (0.0, 0.0)
    accents: float = 0.0
    ornaments: float = 1.0


STOPPING = Manner()
"""The dancer comes to rest at every keypose, as in a dance that is taught step by step."""

FLOWING = Manner(
    hold=(0.1, 0.3), passes=0.5, freezes=0.02, soft=0.95, speed=(0.0, 0.5), accents=0.6,
    ornaments=1.5,
)  # fmt: skip
"""The dancer moves on at most keyposes. The energy is below T1 in 20 % of the time; in 15 recorded
dances (CMU, Bandai Namco) also in 20 %, with `STOPPING` in 43 %."""


@dataclass(frozen=True, slots=True)
class Moment:
    """A pose of the dance, and its times in seconds.

    beat: the index of its beat. arrive, leave: the body rests between them. time: the time of the
    pose. All three are equal if the body does not slow down. speed: the share of its speed with
    which the body goes through a keypose; 0 if it rests.
    """

    beat: int
    arrive: float
    time: float
    leave: float
    speed: float = 0.0

    @property
    def is_held(self) -> bool:
        """Whether the body rests or slows down, so that the pose is a keypose."""
        return self.leave > self.arrive

    @property
    def is_stop(self) -> bool:
        """Whether the body comes to rest."""
        return self.is_held and not self.speed


@dataclass(frozen=True, slots=True)
class Counts:
    """The beats and poses of a dance.

    beats: (b,) s, rising. moments: the poses in order of time. interval: the nominal beat, s.
    """

    beats: FloatArray
    moments: tuple[Moment, ...]
    interval: float

    @property
    def held(self) -> tuple[Moment, ...]:
        """The keyposes, in order of time."""
        return tuple(moment for moment in self.moments if moment.is_held)

    def phase(self, times: FloatArray) -> FloatArray:
        """(frames,) the number of beats since the first one, at `times` (frames,) in seconds.

        Before the first and after the last beat, the beat continues evenly.
        """
        at = np.arange(len(self.beats))
        inside = np.interp(times, self.beats, at)
        before = np.minimum(times - self.beats[0], 0.0) / (self.beats[1] - self.beats[0])
        after = np.maximum(times - self.beats[-1], 0.0) / (self.beats[-1] - self.beats[-2])
        return np.asarray(inside + before + after)


def make_counts(
    draw: np.random.RandomState, bpm: float, seconds: float, manner: Manner, *, drift: float
) -> Counts:
    """Beats of about `bpm` (per minute) for `seconds`, and the poses on them.

    drift: the largest relative difference of the tempo from `bpm`.
    """
    beats = _beats(draw, bpm, seconds, drift)
    return Counts(beats, tuple(_moments(draw, beats, manner)), 60.0 / bpm)


def _beats(draw: np.random.RandomState, bpm: float, seconds: float, drift: float) -> FloatArray:
    """(b,) the times of the beats, s. The tempo varies slowly, or changes in one direction."""
    interval = 60.0 / bpm
    count = max(4, int((seconds - interval) / interval))
    at = np.linspace(0.0, 1.0, count)
    turns, start = draw.uniform(0.5, 1.5), draw.uniform(0.0, 2.0 * np.pi)
    steady = draw.choice([-1.0, 1.0]) * (2.0 * at - 1.0)
    course = steady if draw.rand() < 0.4 else np.sin(2.0 * np.pi * turns * at + start)
    intervals = interval * np.exp(drift * course)
    first = max(interval * draw.uniform(0.6, 1.0), MIN_FIRST_BEAT)
    return np.asarray(first + np.cumsum(intervals) - intervals[0])


def _moments(draw: np.random.RandomState, beats: FloatArray, manner: Manner) -> list[Moment]:
    rhythm = RHYTHMS[draw.randint(len(RHYTHMS))]
    hold = draw.uniform(*manner.hold)
    moments: list[Moment] = []
    beat, count = 0, 0
    while beat < len(beats):
        gap = rhythm[count % len(rhythm)] + int(draw.rand() < manner.passes)
        frozen = draw.rand() < manner.freezes and beat + 1 < len(beats)
        gap = max(gap, 2) if frozen else gap
        keypose = _keypose(draw, beats, beat, hold, frozen)
        # Nothing is drawn for a manner without soft keyposes: its dances stay the same.
        if moments and not frozen and manner.soft and draw.rand() < manner.soft:
            keypose = replace(keypose, speed=float(draw.uniform(*manner.speed)))
        moments.append(keypose)
        for passed in range(beat + 1 + frozen, min(beat + gap, len(beats))):
            if draw.rand() < PASSING_POSE_PROBABILITY:
                time = float(beats[passed])
                moments.append(Moment(passed, time, time, time))
        beat, count = beat + gap, count + 1
    return _until_last_keypose(moments)


def _keypose(
    draw: np.random.RandomState, beats: FloatArray, beat: int, hold: float, frozen: bool
) -> Moment:
    near = beats[min(beat, len(beats) - 2) : min(beat, len(beats) - 2) + 2]
    length = float(near[1] - near[0])
    half = 0.5 * hold * draw.uniform(0.7, 1.3) * length
    time = float(
        beats[beat] + np.clip(TIMING_ERROR * draw.randn(), -MAX_TIMING_ERROR, MAX_TIMING_ERROR)
    )
    return Moment(beat, time - half, time, time + half + (length if frozen else 0.0))


def _until_last_keypose(moments: list[Moment]) -> list[Moment]:
    """The moments without the poses after the last keypose, at which the dance ends at rest."""
    while not moments[-1].is_held:
        moments.pop()
    return [*moments[:-1], replace(moments[-1], speed=0.0)]
