"""When in a motion its recording begins, where nobody says: the stops must meet the beats.

A steady beat tells the offset but for whole beats. Which of the beats it is shows a little:
where the tempo drifts, the stops fit the right beats best; a recording is there for all of the
motion; and its band is fullest while somebody dances. What is found comes with the probability
that it is right with the beats counted too; the beats of the clip are right all the same.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from app.analysis.rhythm.beats import FINE, WIDTH, Stops
from app.analysis.rhythm.onsets import RATE, Onsets
from app.numerics.arrays import FloatArray, IntArray

MIN_COVERED = 0.6
"""Of the motion or the recording, whichever is shorter, that the two must share."""

AS_GOOD = 0.35
"""Share of the stops by which a lag may meet fewer beats than the best one and still be tried."""

MET, FITTING, COVERED, FULLER, PER_SECOND = 18.0, 0.15, 13.0, 6.8, -0.05
"""Weights of the share of stops that meet beats, of how closely they do (log likelihood), of the
share of the motion that is recorded, of how much more begins while the motion lasts than before
and after, and of each second from 0. A multinomial logit on 108 of the demo's dances with clicks,
arranged music, and music that is the same throughout, a third each."""

MIN_SPREAD = 0.015
"""Seconds (standard deviation) that dancers miss a beat by at least."""

NEAR = 0.3
"""Of a beat: stops so near to one are meant for it."""

SMOOTH = 0.75
"""Beats (standard deviation) over which the fullness of the music is told."""

TRIALS = 10.0
"""Phases of a beat that may meet the stops by accident, about."""

MIN_CONFIDENCE = 0.9
"""Below, the offset is not known."""


@dataclass(frozen=True, slots=True)
class Offset:
    """seconds: time of the motion at which the recording begins; confidence: 0..1, how surely
    the stops meet its beats there, whole beats left aside; beat: seconds, of which `seconds` may
    be wrong by a multiple; beat_confidence: 0..1, the probability that it is not. Both are 1
    where a client said it."""

    seconds: float
    confidence: float
    is_given: bool
    beat: float
    beat_confidence: float


def estimate_offset(stops: Stops, beats: FloatArray, onsets: Onsets) -> Offset | None:
    """The offset of a recording of these `onsets`, with `beats` (b,) s from its beginning.

    None where the stops keep no phase of the beat.
    """
    if len(beats) < 2 or not len(stops.times):
        return None
    met = _met(stops, beats, onsets.duration)
    if not len(met.lags):
        return None
    beat = float(np.median(np.diff(beats)))
    score = MET * met.share + PER_SECOND * np.abs(met.lags) / FINE
    score += FITTING * np.array([_fit(stops, beats + lag / FINE, beat) for lag in met.lags])
    score += COVERED * met.covered + FULLER * _fuller(met, onsets, beat)
    likely = np.exp(score - score.max())
    best = int(score.argmax())
    same = np.abs(met.lags - met.lags[best]) < 0.5 * beat * FINE
    seconds = round(float(met.lags[best] / FINE), 3)
    confidence = _confidence(stops, beats + seconds)
    if confidence < MIN_CONFIDENCE:
        return None
    return Offset(seconds, confidence, False, beat, float(likely[same].sum() / likely.sum()))


@dataclass(frozen=True, slots=True)
class _Met:
    """Lags (c,) of the recording, in frames of FINE Hz, at which stops meet beats well; `share`
    of the stops that do, `covered` of the motion; frames of both: moved, heard."""

    lags: IntArray
    share: FloatArray
    covered: FloatArray
    moved: int
    heard: int


def _met(stops: Stops, beats: FloatArray, duration: float) -> _Met:
    heard, moved = _humps(beats, int(duration * FINE) + 1), stops.curve
    share = scipy.signal.fftconvolve(moved, heard[::-1]) / max(float(np.square(moved).sum()), 1e-9)
    lags = np.arange(-len(heard) + 1, len(moved))
    shared = np.minimum(len(moved), lags + len(heard)) - np.maximum(0, lags)
    share[shared < MIN_COVERED * min(len(moved), len(heard))] = 0.0
    inner = (share[1:-1] >= share[:-2]) & (share[1:-1] > share[2:])
    tops = np.flatnonzero(inner) + 1
    tops = tops[share[tops] > max(float(share.max()) - AS_GOOD, 0.0)]
    return _Met(lags[tops], share[tops], shared[tops] / len(moved), len(moved), len(heard))


def _humps(times: FloatArray, count: int) -> FloatArray:
    grid = np.arange(count) / FINE
    near = np.abs(grid - times[_nearest(grid, times)])
    return np.asarray(np.exp(-0.5 * np.square(near / WIDTH)))


def _nearest(times: FloatArray, beats: FloatArray) -> IntArray:
    """(t,) index of the beat nearest to each time."""
    middles = 0.5 * (beats[1:] + beats[:-1])
    return np.searchsorted(middles, times)


def _fit(stops: Stops, beats: FloatArray, beat: float) -> float:
    """Log likelihood of how far the stops near `beats` (b,) are from them, evenly early or late."""
    within = (stops.times > beats[0] - beat) & (stops.times < beats[-1] + beat)
    off = stops.times[within] - beats[_nearest(stops.times[within], beats)]
    near = np.abs(off) < NEAR * beat
    off, weights = off[near], stops.weights[within][near]
    if not len(off):
        return 0.0
    spread = float(np.average(np.square(off - np.average(off, weights=weights)), weights=weights))
    return -0.5 * max(float(weights.sum()), 1.0) * float(np.log(spread + MIN_SPREAD**2))


def _fuller(met: _Met, onsets: Onsets, beat: float) -> FloatArray:
    """(c,) by how much more begins to sound within the motion than outside, -1..1 or so: the
    correlation of the music's fullness with being danced to."""
    smooth = scipy.ndimage.gaussian_filter1d(onsets.rise, SMOOTH * beat * RATE)
    full = np.interp(np.arange(met.heard) / FINE, np.arange(len(smooth)) / RATE, smooth)
    sums = np.concatenate([[0.0], np.cumsum(full)])
    first = np.maximum(0, -met.lags)
    stop = np.minimum(met.moved - met.lags, met.heard)
    count = stop - first
    inside, outside = sums[stop] - sums[first], met.heard - count
    apart = inside / count - (sums[-1] - inside) / np.maximum(outside, 1)
    spread = float(full.std()) + 0.1 * float(full.mean()) + 1e-12
    return np.asarray(apart * np.sqrt(count * outside) / met.heard / spread)


def _confidence(stops: Stops, beats: FloatArray) -> float:
    """Rayleigh's test: stops at random meet a phase as well with probability exp(-k R^2)."""
    beat = float(np.median(np.diff(beats)))
    within = (stops.times > beats[0] - beat) & (stops.times < beats[-1] + beat)
    if not within.any():
        return 0.0
    times, weights = stops.times[within], stops.weights[within]
    phases = np.exp(2j * np.pi * (times - beats[_nearest(times, beats)]) / beat)
    together = float(np.abs((weights * phases).sum()) / weights.sum())
    return float(np.clip(1.0 - TRIALS * np.exp(-len(times) * together**2), 0.0, 1.0))
