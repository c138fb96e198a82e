"""Estimates the time of a motion at which its audio recording begins.

With the right offset, the stops of the motion coincide with the beats. A steady beat gives the
offset only up to whole beats. Three weak clues show which beat it is: if the tempo drifts, the
stops fit the right beats best; a recording usually covers the whole motion; and the music is
loudest while somebody dances. The result has the probability that the number of whole beats is
right. The beats of the clip are right even if this number is wrong.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from app.analysis.rhythm.beats import STOP_RATE, WIDTH, Stops
from app.analysis.rhythm.onsets import RATE, Onsets
from app.numerics.arrays import FloatArray, IntArray

MIN_COVERED = 0.6
"""Motion and recording must overlap by at least this share of the shorter one."""

MAX_SHARE_DIFFERENCE = 0.35
"""A lag is tried if its share of coinciding stops is less than this below the best share."""

COINCIDENCE_WEIGHT, LIKELIHOOD_WEIGHT, COVERAGE_WEIGHT, FULLNESS_WEIGHT, SECONDS_WEIGHT = (
    18.0,
    0.15,
    13.0,
    6.8,
    -0.05,
)
"""Weights: of the share of stops that coincide with beats; of how closely they do (log
likelihood); of the share of the motion that is recorded; of how much fuller the music is during the
motion than before and after it; and of each second between the start of the motion and the start
of the recording. They come from a multinomial logit on
108 of the demo's dances: a third with clicks, a third with arranged music, and a third with music
that does not change."""

MIN_SPREAD = 0.015
"""Seconds: the smallest standard deviation of dancers' stops from their beats."""

MAX_STOP_OFFSET = 0.3
"""In beats. A stop that is at most this far from a beat belongs to it."""

SMOOTHING = 0.75
"""Beats (standard deviation) over which the fullness of the music is smoothed."""

PHASES_TRIED = 10.0
"""The approximate number of independent phases that are tried. Each may fit the stops by chance."""

MIN_CONFIDENCE = 0.9
"""With a lower confidence the offset counts as unknown."""


@dataclass(frozen=True, slots=True)
class Offset:
    """When a recording begins.

    seconds: the time of the motion at which it begins. confidence: 0..1, how certain it is that
    the stops coincide with the beats. is_given: whether a client gave the offset; then both
    confidences are 1. beat: the length of a beat in
    seconds; `seconds` may be wrong by a multiple of it. beat_confidence: 0..1, the probability
    that it is not.
    """

    seconds: float
    confidence: float
    is_given: bool
    beat: float
    beat_confidence: float


def estimate_offset(stops: Stops, beats: FloatArray, onsets: Onsets) -> Offset | None:
    """The offset of a recording, or None if the stops have no common phase of the beat.

    stops: those of the motion. beats: (b,) those of the recording, in seconds from its
    beginning. onsets: those of the recording.
    """
    if len(beats) < 2 or not len(stops.times):
        return None
    coincidences = _coincidences(stops, beats, onsets.duration)
    if not len(coincidences.lags):
        return None
    beat = float(np.median(np.diff(beats)))
    score = (
        COINCIDENCE_WEIGHT * coincidences.share
        + SECONDS_WEIGHT * np.abs(coincidences.lags) / STOP_RATE
    )
    score += LIKELIHOOD_WEIGHT * np.array(
        [_fit(stops, beats + lag / STOP_RATE, beat) for lag in coincidences.lags]
    )
    score += COVERAGE_WEIGHT * coincidences.covered + FULLNESS_WEIGHT * _fullness_contrast(
        coincidences, onsets, beat
    )
    likelihood = np.exp(score - score.max())
    best = int(score.argmax())
    same = np.abs(coincidences.lags - coincidences.lags[best]) < 0.5 * beat * STOP_RATE
    seconds = round(float(coincidences.lags[best] / STOP_RATE), 3)
    confidence = _confidence(stops, beats + seconds)
    if confidence < MIN_CONFIDENCE:
        return None
    return Offset(
        seconds, confidence, False, beat, float(likelihood[same].sum() / likelihood.sum())
    )


@dataclass(frozen=True, slots=True)
class _Coincidences:
    """The lags of the recording at which many stops coincide with beats.

    lags: (c,) in frames at STOP_RATE Hz. share: (c,) of the stops that coincide. covered: (c,) the
    share of the motion that is recorded. moved, recorded: frames of the motion and the recording.
    """

    lags: IntArray
    share: FloatArray
    covered: FloatArray
    moved: int
    recorded: int


def _coincidences(stops: Stops, beats: FloatArray, duration: float) -> _Coincidences:
    recorded, moved = _humps(beats, int(duration * STOP_RATE) + 1), stops.curve
    # the correlation of both curves gives the share of coinciding stops for every lag at once
    share = scipy.signal.fftconvolve(moved, recorded[::-1]) / max(
        float(np.square(moved).sum()), 1e-9
    )
    lags = np.arange(-len(recorded) + 1, len(moved))
    shared = np.minimum(len(moved), lags + len(recorded)) - np.maximum(0, lags)
    share[shared < MIN_COVERED * min(len(moved), len(recorded))] = 0.0
    inner = (share[1:-1] >= share[:-2]) & (share[1:-1] > share[2:])
    tops = np.flatnonzero(inner) + 1
    tops = tops[share[tops] > max(float(share.max()) - MAX_SHARE_DIFFERENCE, 0.0)]
    return _Coincidences(
        lags[tops], share[tops], shared[tops] / len(moved), len(moved), len(recorded)
    )


def _humps(times: FloatArray, count: int) -> FloatArray:
    grid = np.arange(count) / STOP_RATE
    near = np.abs(grid - times[_nearest(grid, times)])
    return np.asarray(np.exp(-0.5 * np.square(near / WIDTH)))


def _nearest(times: FloatArray, beats: FloatArray) -> IntArray:
    """(t,) the index of the nearest of `beats` (b,) for each of `times` (t,)."""
    middles = 0.5 * (beats[1:] + beats[:-1])
    return np.searchsorted(middles, times)


def _fit(stops: Stops, beats: FloatArray, beat: float) -> float:
    """The log likelihood of the distances between stops and their nearest `beats` (b,).

    A constant delay of all stops does not count.
    """
    within = (stops.times > beats[0] - beat) & (stops.times < beats[-1] + beat)
    off = stops.times[within] - beats[_nearest(stops.times[within], beats)]
    near = np.abs(off) < MAX_STOP_OFFSET * beat
    off, weights = off[near], stops.weights[within][near]
    if not len(off):
        return 0.0
    spread = float(np.average(np.square(off - np.average(off, weights=weights)), weights=weights))
    return -0.5 * max(float(weights.sum()), 1.0) * float(np.log(spread + MIN_SPREAD**2))


def _fullness_contrast(coincidences: _Coincidences, onsets: Onsets, beat: float) -> FloatArray:
    """(c,) how much fuller the music is during the motion than outside, about -1..1.

    This is the correlation of the music's fullness with whether the moment is within the motion.
    """
    smooth = scipy.ndimage.gaussian_filter1d(onsets.rise, SMOOTHING * beat * RATE)
    full = np.interp(
        np.arange(coincidences.recorded) / STOP_RATE, np.arange(len(smooth)) / RATE, smooth
    )
    sums = np.concatenate([[0.0], np.cumsum(full)])
    first = np.maximum(0, -coincidences.lags)
    stop = np.minimum(coincidences.moved - coincidences.lags, coincidences.recorded)
    count = stop - first
    inside, outside = sums[stop] - sums[first], coincidences.recorded - count
    apart = inside / count - (sums[-1] - inside) / np.maximum(outside, 1)
    spread = float(full.std()) + 0.1 * float(full.mean()) + 1e-12
    return np.asarray(apart * np.sqrt(count * outside) / coincidences.recorded / spread)


def _confidence(stops: Stops, beats: FloatArray) -> float:
    """The confidence, 0..1, that the stops have a common phase of the beat (Rayleigh's test).

    The mean phase vector of k random stops has the length R or more with a probability of about
    exp(-k R^2).
    """
    beat = float(np.median(np.diff(beats)))
    within = (stops.times > beats[0] - beat) & (stops.times < beats[-1] + beat)
    if not within.any():
        return 0.0
    times, weights = stops.times[within], stops.weights[within]
    phases = np.exp(2j * np.pi * (times - beats[_nearest(times, beats)]) / beat)
    phase_length = float(np.abs((weights * phases).sum()) / weights.sum())
    return float(np.clip(1.0 - PHASES_TRIED * np.exp(-len(times) * phase_length**2), 0.0, 1.0))
