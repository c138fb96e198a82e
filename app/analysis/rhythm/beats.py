"""The type of beats, and the beats of a motion, estimated from its energy.

Dancers come to rest on beats, though not on every beat. In the logarithm of the energy, rests are
as strong as bursts. If its deep minima repeat, their period is the beat or a simple ratio of it.
Each such tempo is tracked through its drift (`beat_tracking`). The chosen tempo is the one for
which most beats have a stop and most stops are on a beat (the octave check). If the stops have no
common beat, there are no beats. The steps of a walk are stops too, so its beats are its steps.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache

import numpy as np
import scipy
from numpy.polynomial.legendre import legvander

from app.analysis.rhythm.beat_tracking import MIN_BEATS, likely_periods, track
from app.numerics.arrays import FloatArray
from app.numerics.quantiles import median

MIN_TEMPO, MAX_TEMPO = 40.0, 200.0
"""Beats per minute."""

MAX_PERIODS = 10
"""How many of the strongest periods of the stops are used to derive tempi."""

TREND = 2.0
"""Seconds (standard deviation). Slower changes of the energy are not rhythm."""

ENERGY_FLOOR = 0.05
"""Added to the energy, as a share of its median, so that the logarithm is finite."""

MIN_PROMINENCE = 0.8
"""The smallest prominence of a stop, in standard deviations of the log energy."""

FULL_PROMINENCE = 2.0
"""The prominence, in the same unit, from which the weight of a stop is 1."""

BOTTOM_SHARE = 0.3
"""The share of its prominence up to which a minimum is one stop. Its middle is the stop's time."""

STOP_RATE = 60.0
"""Hz: the rate of the curve of stops."""

WIDTH = 0.05
"""Seconds (standard deviation): the width of one stop in that curve."""

MAX_STOP_DISTANCE = 39 * WIDTH
"""Seconds beyond which a stop adds nothing: exp(-39^2 / 2) is 0 in floating point."""

STOP_HEIGHT, TIGHTNESS = 4.0, 300.0
"""The height of a stop of weight 1 in that curve; the tightness of `beat_tracking.track`."""

MAX_INTERVAL_RATIO = 1.25
"""The largest factor between an interval and the beat. A larger one would cost more than a stop
gains."""

BEATS_PER_BEND, MAX_BENDS = 12, 5
"""The degree of the curve of beats grows by 1 in this many beats, up to MAX_BENDS."""

STIFFNESS = 0.3
"""The penalty of each coefficient of a higher degree, in stops."""

MAX_STOP_OFFSET = 0.15
"""In beats. A stop that is at most this far from a beat is on it."""

USUAL_TEMPO, TEMPO_WEIGHT = 95.0, -1.9
"""Beats per minute of most dances, and the weight of the squared distance from it in octaves."""

STOP_SHARE_WEIGHT, BEAT_SHARE_WEIGHT, PHASE_WEIGHT = 3.5, 3.9, 5.4
"""Weights in the choice of a tempo: of the share of beats that have a stop, of the share of stops
that are on a beat, and of the length of the stops' mean phase vector. They come from a multinomial
logit on 160 of the demo's dances, with noise of up to 25 mm."""

CONFIDENCE_WEIGHTS = (5.9, 0.7, 5.2, 0.6, -12.0)
"""The coefficients of a logit: of these three numbers, of Rayleigh's statistic (the number of
stops, at most MAX_STOPS, times the squared length of the vector), and of 1. It was fitted on the
same dances and parts of them, against 600 motions that stop at random, wander or tremble; both
groups have the same total weight."""

MAX_STOPS = 24
MIN_CONFIDENCE = 0.45
"""The smallest confidence with which beats are reported. 5 % of aimless motions have more, 12 % of
motions that stop at random, and 97 % of dances."""

END_BEATS = 4
"""Intervals at an end that give the tempo beyond it. One alone may be off by 20 ms."""


class BeatSource(StrEnum):
    """The source of the beats of a clip."""

    GIVEN = "given"
    """A client listed their times."""

    TEMPO = "tempo"
    """A client gave the tempo. Their times were found in the recording or in the motion."""

    AUDIO = "audio"
    """They were found in the recording."""

    MOTION = "motion"
    """They were found in the energy of the motion."""

    NONE = "none"
    """No beats were found. This is a valid result."""


@dataclass(frozen=True, slots=True)
class Beats:
    """The beats of a clip.

    times: (beats,) seconds, rising. tempo: beats per minute, None if there are no beats.
    confidence: 0..1, how certain it is that the beats are not chance; for those of a recording the
    probability that their phase and level are those of the dance.
    """

    times: FloatArray
    tempo: float | None
    confidence: float
    source: BeatSource = BeatSource.MOTION


def no_beats(confidence: float = 0.0) -> Beats:
    """No beats; confidence: that of the best beats that were rejected."""
    return Beats(np.zeros(0), None, confidence, BeatSource.NONE)


def given_beats(times: FloatArray) -> Beats:
    """The beats that a client lists; times: (beats,) seconds, rising."""
    steps = np.diff(times)
    tempo = round(float(60.0 / np.median(steps)), 6) if len(steps) else None
    return Beats(np.asarray(times, dtype=np.float64), tempo, 1.0, BeatSource.GIVEN)


def find_beats(energy: FloatArray, rate: float) -> Beats:
    """The beats of an energy curve (n,) at `rate` Hz; none if its stops have no common beat."""
    stops = find_stops(energy, rate)
    if len(stops.times) < MIN_BEATS:
        return no_beats()
    shortest, longest = 60.0 * STOP_RATE / MAX_TEMPO, 60.0 * STOP_RATE / MIN_TEMPO
    best, found = None, -np.inf
    for period in likely_periods(stops.curve, shortest, longest, MAX_PERIODS):
        candidate = _track_tempo(stops, period)
        if candidate is not None and candidate.plausibility > found:
            best, found = candidate, candidate.plausibility
    if best is None or best.confidence < MIN_CONFIDENCE:
        return no_beats(0.0 if best is None else best.confidence)
    times = continued(best.beats, stops.duration)
    return Beats(times, best.tempo, best.confidence, BeatSource.MOTION)


def beats_of_tempo(energy: FloatArray, rate: float, tempo: float) -> Beats:
    """Beats of a given `tempo` (per minute), at the times when the motion stops.

    energy: (n,) at `rate` Hz. If the motion does not stop, the beats begin at its first frame.
    The confidence is that of the times of the beats.
    """
    stops = find_stops(energy, rate)
    candidate = _track_tempo(stops, 60.0 * STOP_RATE / tempo)
    if candidate is None:
        times = np.arange(0.0, max(stops.duration, 1e-9), 60.0 / tempo)
        return Beats(times, tempo, 0.0, BeatSource.TEMPO)
    times = continued(candidate.beats, stops.duration)
    return Beats(times, tempo, candidate.confidence, BeatSource.TEMPO)


@dataclass(frozen=True, slots=True)
class Stops:
    """The stops of a motion: the deep minima of its energy.

    times: (r,) seconds. weights: (r,) 0..1, larger for deeper minima. curve: (m,) at STOP_RATE Hz,
    with a hump at each stop. duration: of the motion, in seconds.
    """

    times: FloatArray
    weights: FloatArray
    curve: FloatArray
    duration: float


def find_stops(energy: FloatArray, rate: float) -> Stops:
    """The stops of a motion, from its energy curve (n,) at `rate` Hz."""
    level = _log_energy(energy, rate)
    spread = float(level.std()) if len(level) else 0.0
    duration = max(len(energy) - 1, 0) / rate
    grid = np.arange(int(duration * STOP_RATE) + 1) / STOP_RATE
    if not spread > 0:
        return Stops(np.zeros(0), np.zeros(0), np.zeros(len(grid)), duration)
    minima, found = scipy.signal.find_peaks(
        -level, prominence=MIN_PROMINENCE * spread, plateau_size=1
    )
    depths = found["prominences"]
    middles = [_middle(level, m, d) for m, d in zip(minima, depths, strict=True)]
    times, weights = np.array(middles) / rate, np.minimum(depths / (FULL_PROMINENCE * spread), 1.0)
    curve = np.zeros(len(grid))
    for time, weight in zip(times, weights, strict=True):
        near = slice(
            max(0, int((time - MAX_STOP_DISTANCE) * STOP_RATE)),
            int((time + MAX_STOP_DISTANCE) * STOP_RATE) + 2,
        )
        hump = weight * np.exp(-0.5 * np.square((grid[near] - time) / WIDTH))
        curve[near] = np.maximum(curve[near], hump)
    return Stops(times, weights, curve, duration)


def _log_energy(energy: FloatArray, rate: float) -> FloatArray:
    """(n,) the logarithm of the energy, without its slow changes; 0 if nothing moves."""
    highest = float(energy.max(initial=0.0))
    if not highest > 0:
        return np.zeros(len(energy))
    level = np.log(energy + max(ENERGY_FLOOR * float(median(energy)), 1e-6 * highest))
    return np.asarray(level - scipy.ndimage.gaussian_filter1d(level, TREND * rate, mode="reflect"))


def _middle(level: FloatArray, minimum: int, depth: float) -> float:
    """The middle of the frames around a minimum that are nearly as low.

    level: (n,) log energy. minimum: a frame. depth: its prominence.
    """
    low = level <= level[minimum] + BOTTOM_SHARE * depth
    before = np.flatnonzero(~low[:minimum])
    after = np.flatnonzero(~low[minimum:])
    first = before[-1] + 1 if len(before) else 0
    last = minimum + after[0] - 1 if len(after) else len(level) - 1
    return 0.5 * float(first + last)


@dataclass(frozen=True, slots=True)
class _TempoTrack:
    """The beats for one tempo.

    beats: (b,) seconds, rising, between the first and the last stop. plausibility: the tempo with
    the largest one is chosen. confidence: 0..1.
    """

    beats: FloatArray
    plausibility: float
    confidence: float

    @property
    def tempo(self) -> float:
        return 60.0 / float(np.median(np.diff(self.beats)))


def _track_tempo(stops: Stops, period: float) -> _TempoTrack | None:
    """The beats whose interval is about `period` frames of `stops.curve`; None if too few."""
    if len(stops.times) < MIN_BEATS:
        return None
    tracked = track(STOP_HEIGHT * stops.curve, period, TIGHTNESS, MAX_INTERVAL_RATIO) / STOP_RATE
    if len(tracked) < MIN_BEATS:
        return None
    beats = _smoothed(tracked, stops)
    steps = np.diff(beats)
    if not (steps > 0).all():
        return None
    beat = float(median(steps))
    off = (stops.times[:, None] - beats) / beat
    away = np.abs(off)
    nearest = off[np.arange(len(off)), away.argmin(axis=1)]
    weights, total = stops.weights, float(stops.weights.sum())
    with_stop = float((weights[:, None] * (away < MAX_STOP_OFFSET)).max(axis=0).mean())
    on_beat = float(weights[np.abs(nearest) < MAX_STOP_OFFSET].sum()) / total
    phase_length = float(np.abs((weights * np.exp(2j * np.pi * nearest)).sum())) / total
    octaves = np.log2(60.0 / beat / USUAL_TEMPO)
    plausibility = (
        STOP_SHARE_WEIGHT * with_stop + BEAT_SHARE_WEIGHT * on_beat + PHASE_WEIGHT * phase_length
    )
    evidence = (
        with_stop,
        on_beat,
        phase_length,
        min(len(weights), MAX_STOPS) * phase_length**2,
        1.0,
    )
    logit = float(np.dot(CONFIDENCE_WEIGHTS, evidence))
    return _TempoTrack(
        beats, float(plausibility + TEMPO_WEIGHT * octaves**2), float(1.0 / (1.0 + np.exp(-logit)))
    )


def _smoothed(beats: FloatArray, stops: Stops) -> FloatArray:
    """(b,) `beats` (b,), in seconds, moved to a smooth curve through the stops near them.

    The tempo of musicians drifts, but does not jump. The curve is a polynomial of low degree over
    the numbers of the beats, fitted by least squares.
    """
    nearest = np.abs(stops.times[:, None] - beats).argmin(axis=1)
    beat = float(median(np.diff(beats)))
    near = np.abs(stops.times - beats[nearest]) < 0.25 * beat
    degree = min(1 + len(beats) // BEATS_PER_BEND, MAX_BENDS)
    if int(near.sum()) < degree + 2:
        return beats
    polynomials = _polynomials(len(beats), degree)
    basis, weights = polynomials[nearest[near]], stops.weights[near]
    stiff = np.diag([0.0, 0.0, *[STIFFNESS] * (degree - 1)])
    left = (basis * weights[:, None]).T @ basis + stiff
    right = (basis * weights[:, None]).T @ stops.times[near]
    return np.asarray(polynomials @ np.linalg.solve(left, right))


@lru_cache(maxsize=1024)
def _polynomials(beats: int, degree: int) -> FloatArray:
    """(beats, degree + 1) the Legendre polynomials at evenly spaced beats, -1..1."""
    # Cached, because every tempo of every clip asks for them.
    return np.asarray(legvander(2.0 * np.arange(beats) / (beats - 1) - 1.0, degree))


def continued(beats: FloatArray, duration: float) -> FloatArray:
    """`beats` (b,), b >= 2, continued evenly to both ends of a clip of `duration` seconds.

    Beats outside the clip are left out.
    """
    intervals = np.diff(beats)
    first, last = (float(some.mean()) for some in (intervals[:END_BEATS], intervals[-END_BEATS:]))
    before = np.arange(beats[0] - first, -1e-9, -first)[::-1]
    after = np.arange(beats[-1] + last, duration + 1e-9, last)
    every = np.concatenate([before, beats, after])
    return np.asarray(every[(every >= 0.0) & (every <= duration)])
