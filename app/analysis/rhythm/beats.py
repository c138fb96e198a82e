"""The beat of a motion, estimated from its energy (DESIGN 5 and 13), and what beats are.

Dancers come to rest on beats, though not on every one. The logarithm of energy makes rests
as strong as bursts; where its deep minima repeat, their period is the beat or a simple ratio
of it. Each such tempo is followed through its drift (`beat_tracking`), and the one is taken
whose beats are mostly rested on, and that most rests are on (the octave check). Where rests
keep no common beat there is none. Steps are stops, too: a walk's beats are its steps.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import scipy
from numpy.polynomial.legendre import legvander

from app.analysis.rhythm.beat_tracking import MIN_BEATS, likely_periods, track
from app.numerics.arrays import FloatArray

SLOWEST, FASTEST = 40.0, 200.0
"""Beats per minute."""

CANDIDATES = 10
"""Strongest periods of the rests from which tempi are derived."""

TREND = 2.0
"""Seconds (standard deviation); slower changes of energy are no rhythm."""

FLOOR = 0.05
"""Of the median energy; keeps the logarithm of rest finite."""

DEEP = 0.8
"""Prominence of the minima that count, in standard deviations of log energy."""

DEEPEST = 2.0
"""Prominence, in the same unit, beyond which a minimum counts no more than others."""

BOTTOM = 0.3
"""Share of its prominence up to which a minimum is one rest, whose middle is its time."""

FINE = 60.0
"""Hz of the curve of rests that is followed."""

WIDTH = 0.05
"""Seconds (standard deviation) of one rest in that curve."""

HUMP = 39 * WIDTH
"""Seconds beyond which a rest adds nothing to it: exp(-39^2 / 2) is 0 in floating point."""

HEIGHT, TIGHTNESS = 4.0, 300.0
"""Of a full rest in that curve; see `beat_tracking.track`."""

REACH = 1.25
"""Factor on the beat that any interval keeps within: further off costs more than a rest gains."""

BEATS_PER_BEND, MAX_BENDS = 12, 5
"""A tempo may change its course once in so many beats, and so often in all."""

STIFFNESS = 0.3
"""Weight against each bend, in rests."""

NEAR = 0.15
"""Of a beat: rests so near to one are on it."""

USUAL, UNUSUAL = 95.0, -1.9
"""Beats per minute that most dances are near; weight of the squared octaves from there."""

RESTED, EXPLAINED, TOGETHER = 3.5, 3.9, 5.4
"""Weights, in the choice of a tempo, of the share of beats that are rests, of the share of
rests that are beats, and of the length of the rests' mean phase vector: a multinomial logit
on 160 of the demo's dances by seed, of noise up to 25 mm."""

CONFIDENCE = (5.9, 0.7, 5.2, 0.6, -12.0)
"""A logit of those three, of Rayleigh's statistic (the number of rests, MAX_STOPS at most, times
the squared length of the vector) and 1: the same dances, and parts of them, against 600 motions
that stop at random, wander or tremble, both weighted alike."""

MAX_STOPS = 24
MIN_CONFIDENCE = 0.45
"""Below, no beats are reported: of a hundred aimless motions five have more, of a hundred that
stop at random twelve, of a hundred dances 97."""


class BeatSource(StrEnum):
    """From what beats are known; each goes before those below it."""

    GIVEN = "given"
    """A client listed their times."""

    TEMPO = "tempo"
    """A client told the tempo; their places were sought in the recording or the motion."""

    AUDIO = "audio"
    """Found in the recording."""

    MOTION = "motion"
    """Found in the motion's energy."""

    NONE = "none"
    """No beats were found, which is an answer."""


@dataclass(frozen=True, slots=True)
class Beats:
    """Beats of a clip: `times` (beats,) seconds; `tempo` beats per minute, None where none.

    confidence: 0..1, how surely they are no accident.
    """

    times: FloatArray
    tempo: float | None
    confidence: float
    source: BeatSource = BeatSource.MOTION


def no_beats(confidence: float = 0.0) -> Beats:
    """None, with the `confidence` of the best there would have been."""
    return Beats(np.zeros(0), None, confidence, BeatSource.NONE)


def given_beats(times: FloatArray) -> Beats:
    """Beats that somebody lists: (beats,) seconds, rising."""
    steps = np.diff(times)
    tempo = round(float(60.0 / np.median(steps)), 6) if len(steps) else None
    return Beats(np.asarray(times, dtype=np.float64), tempo, 1.0, BeatSource.GIVEN)


def find_beats(energy: FloatArray, rate: float) -> Beats:
    """The beats of an energy curve (n,) of `rate` Hz; none where its rests keep no beat."""
    stops = find_stops(energy, rate)
    shortest, longest = 60.0 * FINE / FASTEST, 60.0 * FINE / SLOWEST
    best, found = None, -np.inf
    for period in likely_periods(stops.curve, shortest, longest, CANDIDATES):
        followed = _follow(stops, period)
        if followed is not None and followed.plausibility > found:
            best, found = followed, followed.plausibility
    if best is None or best.confidence < MIN_CONFIDENCE:
        return no_beats(0.0 if best is None else best.confidence)
    times = through(best.beats, stops.duration)
    return Beats(times, best.tempo, best.confidence, BeatSource.MOTION)


def beats_of_tempo(energy: FloatArray, rate: float, tempo: float) -> Beats:
    """Beats of a `tempo` that is told, placed where the motion rests, from its first frame if
    it does not; confidence: that of their places."""
    stops = find_stops(energy, rate)
    followed = _follow(stops, 60.0 * FINE / tempo)
    if followed is None:
        times = np.arange(0.0, max(stops.duration, 1e-9), 60.0 / tempo)
        return Beats(times, tempo, 0.0, BeatSource.TEMPO)
    times = through(followed.beats, stops.duration)
    return Beats(times, tempo, followed.confidence, BeatSource.TEMPO)


@dataclass(frozen=True, slots=True)
class Stops:
    """The stops of a motion, for its beats.

    times: (r,) s; weights: (r,) 0..1; curve: (m,) at FINE Hz, a hump at each; duration: s.
    """

    times: FloatArray
    weights: FloatArray
    curve: FloatArray
    duration: float


def find_stops(energy: FloatArray, rate: float) -> Stops:
    """Where an energy curve (n,) of `rate` Hz falls to a deep minimum."""
    level = _log_energy(energy, rate)
    spread = float(level.std()) if len(level) else 0.0
    duration = max(len(energy) - 1, 0) / rate
    grid = np.arange(int(duration * FINE) + 1) / FINE
    if not spread > 0:
        return Stops(np.zeros(0), np.zeros(0), np.zeros(len(grid)), duration)
    minima, found = scipy.signal.find_peaks(-level, prominence=DEEP * spread, plateau_size=1)
    depths = found["prominences"]
    middles = [_middle(level, m, d) for m, d in zip(minima, depths, strict=True)]
    times, weights = np.array(middles) / rate, np.minimum(depths / (DEEPEST * spread), 1.0)
    curve = np.zeros(len(grid))
    for time, weight in zip(times, weights, strict=True):
        near = slice(max(0, int((time - HUMP) * FINE)), int((time + HUMP) * FINE) + 2)
        hump = weight * np.exp(-0.5 * np.square((grid[near] - time) / WIDTH))
        curve[near] = np.maximum(curve[near], hump)
    return Stops(times, weights, curve, duration)


def _log_energy(energy: FloatArray, rate: float) -> FloatArray:
    """(n,) logarithm of energy without its slow changes; zeros for what does not move."""
    highest = float(energy.max(initial=0.0))
    if not highest > 0:
        return np.zeros(len(energy))
    level = np.log(energy + max(FLOOR * float(np.median(energy)), 1e-6 * highest))
    return np.asarray(level - scipy.ndimage.gaussian_filter1d(level, TREND * rate, mode="reflect"))


def _middle(level: FloatArray, minimum: int, depth: float) -> float:
    """The middle of the frames around a minimum that are about as low."""
    low = level <= level[minimum] + BOTTOM * depth
    before = np.flatnonzero(~low[:minimum])
    after = np.flatnonzero(~low[minimum:])
    first = before[-1] + 1 if len(before) else 0
    last = minimum + after[0] - 1 if len(after) else len(level) - 1
    return 0.5 * float(first + last)


@dataclass(frozen=True, slots=True)
class _Followed:
    """beats: (b,) s, rising, between the first and the last rest; plausibility: for choosing
    among tempi; confidence: 0..1."""

    beats: FloatArray
    plausibility: float
    confidence: float

    @property
    def tempo(self) -> float:
        return 60.0 / float(np.median(np.diff(self.beats)))


def _follow(stops: Stops, period: float) -> _Followed | None:
    """The beats of about `period` frames of `rests.curve`; None where there are too few."""
    tracked = track(HEIGHT * stops.curve, period, TIGHTNESS, REACH) / FINE
    if len(stops.times) < MIN_BEATS or len(tracked) < MIN_BEATS:
        return None
    beats = _evened(tracked, stops)
    if not (np.diff(beats) > 0).all():
        return None
    beat = float(np.median(np.diff(beats)))
    off = (stops.times[:, None] - beats) / beat
    nearest = off[np.arange(len(off)), np.abs(off).argmin(axis=1)]
    weights, total = stops.weights, float(stops.weights.sum())
    rested = float((weights[:, None] * (np.abs(off) < NEAR)).max(axis=0).mean())
    explained = float(weights[np.abs(nearest) < NEAR].sum()) / total
    together = float(np.abs((weights * np.exp(2j * np.pi * nearest)).sum())) / total
    octaves = np.log2(60.0 / beat / USUAL)
    plausibility = RESTED * rested + EXPLAINED * explained + TOGETHER * together
    evidence = (rested, explained, together, min(len(weights), MAX_STOPS) * together**2, 1.0)
    logit = float(np.dot(CONFIDENCE, evidence))
    return _Followed(
        beats, float(plausibility + UNUSUAL * octaves**2), float(1.0 / (1.0 + np.exp(-logit)))
    )


def _evened(beats: FloatArray, stops: Stops) -> FloatArray:
    """Beats (b,) on a smooth course through the rests near them: musicians drift, they do not
    jump. A polynomial of few degrees over the beats' numbers, by least squares."""
    nearest = np.abs(stops.times[:, None] - beats).argmin(axis=1)
    beat = float(np.median(np.diff(beats)))
    near = np.abs(stops.times - beats[nearest]) < 0.25 * beat
    degree = min(1 + len(beats) // BEATS_PER_BEND, MAX_BENDS)
    if int(near.sum()) < degree + 2:
        return beats
    numbers = 2.0 * np.arange(len(beats)) / (len(beats) - 1) - 1.0
    basis, weights = legvander(numbers[nearest[near]], degree), stops.weights[near]
    stiff = np.diag([0.0, 0.0, *[STIFFNESS] * (degree - 1)])
    left = (basis * weights[:, None]).T @ basis + stiff
    right = (basis * weights[:, None]).T @ stops.times[near]
    return np.asarray(legvander(numbers, degree) @ np.linalg.solve(left, right))


def through(beats: FloatArray, duration: float) -> FloatArray:
    """The beats, gone on with evenly to both ends of a clip of `duration` s."""
    first, last = float(beats[1] - beats[0]), float(beats[-1] - beats[-2])
    before = np.arange(beats[0] - first, -1e-9, -first)[::-1]
    after = np.arange(beats[-1] + last, duration + 1e-9, last)
    every = np.concatenate([before, beats, after])
    return np.asarray(every[(every >= 0.0) & (every <= duration)])
