"""When in a motion its recording begins, where nobody says: the stops must meet the beats.

A steady beat tells the offset but for whole beats: of the offsets that fit about as well the
one nearest to 0 is taken, since most recordings begin when the motion does. The beats of the
clip are right all the same, whichever of them it was.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import fftconvolve

from app.analysis.beats import FINE, WIDTH, Stops
from app.numerics.arrays import FloatArray

LEAST_COVERED = 0.6
"""Of the motion or the recording, whichever is shorter, that the two must share."""

PER_SECOND = 0.01
"""Share of stops that must lie better for each second that an offset is away from 0."""

TRIALS = 10.0
"""Phases of a beat that may meet the stops by accident, about."""

LEAST_CONFIDENCE = 0.9
"""Below, the offset is not known."""


@dataclass(frozen=True, slots=True)
class Offset:
    """seconds: time of the motion at which the recording begins; confidence: 0..1, how surely
    the stops meet its beats there, whole beats left aside; 1 where a client said it."""

    seconds: float
    confidence: float
    is_told: bool


def estimate_offset(stops: Stops, beats: FloatArray, duration: float) -> Offset | None:
    """The offset of a recording of `duration` s with `beats` (b,) s from its beginning.

    None where the stops keep no phase of the beat.
    """
    if len(beats) < 2 or not len(stops.times):
        return None
    heard = _humps(beats, int(duration * FINE) + 1)
    moved = stops.curve
    met = fftconvolve(moved, heard[::-1]) / max(float(np.square(moved).sum()), 1e-9)
    lags = np.arange(-len(heard) + 1, len(moved))
    shared = np.minimum(len(moved), lags + len(heard)) - np.maximum(0, lags)
    enough = shared >= LEAST_COVERED * min(len(moved), len(heard))
    score = np.where(enough, met - PER_SECOND * np.abs(lags) / FINE, -np.inf)
    seconds = float(lags[score.argmax()] / FINE)
    confidence = _confidence(stops, beats + seconds)
    return Offset(seconds, confidence, False) if confidence >= LEAST_CONFIDENCE else None


def _humps(times: FloatArray, count: int) -> FloatArray:
    grid = np.arange(count) / FINE
    near = np.abs(grid - times[_nearest(grid, times)])
    return np.asarray(np.exp(-0.5 * np.square(near / WIDTH)))


def _nearest(times: FloatArray, beats: FloatArray) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    """(t,) index of the beat nearest to each time."""
    middles = 0.5 * (beats[1:] + beats[:-1])
    return np.searchsorted(middles, times)


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
