"""The beats of a recording: its tempo and the time of each beat. The tempo may drift.

Onset strength (`onsets`) repeats with each beat, but also with each bar and each half beat. So
every plausible tempo is tracked by dynamic programming (Ellis 2007, "Beat tracking by dynamic
programming"). The chosen tempo is one that people usually play (the octave check), and whose beats
are strong and similar; but the bass differs from beat to beat, as with bass drum and snare.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy

from app.analysis.rhythm.beat_tracking import (
    MIN_BEATS,
    MULTIPLES,
    autocorrelation,
    likely_periods,
    track,
)
from app.analysis.rhythm.beats import Beats, BeatSource, no_beats
from app.analysis.rhythm.onsets import RATE, Onsets
from app.numerics.arrays import FloatArray, IntArray

MIN_TEMPO, MAX_TEMPO = 40.0, 220.0
"""Beats per minute."""

TIGHTNESS = 100.0
"""The tightness of `track`; onset strength is in units of its standard deviation."""

MAX_PERIODS = 4
"""How many of the strongest periods of the onsets are used to derive tempi."""

USUAL_TEMPO = 112.0
"""Beats per minute of most music (McKinney & Moelants 2006: 100 to 140)."""

TEMPO_WEIGHT, RISE_WEIGHT, BASS_WEIGHT, PULSE_WEIGHT = -2.4, 2.8, -1.25, 4.8
"""Weights: of the squared distance from USUAL_TEMPO in octaves; of the similarity of the rise at
odd and even beats, and of the bass there (natural logarithms of the ratios); and of the pulse. They
come from a multinomial logit on 280 pieces of the demo's music. With each style left out in turn,
it reached F .95."""

MAX_ONSET_DISTANCE = 3
"""Frames around a beat in which its onset may be."""

MAX_SECONDS = 90.0
"""The tempo is chosen from at most this long a part in the middle of the recording."""

WINDOW = 8.0
"""Seconds: the windows in which the pulse is measured. They overlap by half."""

DRIFT = 0.04
"""The largest relative difference of a period from the beat within a window."""

CHANCE_PULSE = (0.06, 0.2)
"""The largest pulse of recordings without a beat: a constant, and a part that falls with the
square root of the number of windows."""

CLEAR_PULSE = 0.16
"""If the pulse is above chance by this, the confidence is 1."""

MIN_CONFIDENCE = 0.5
"""The smallest confidence with which beats are reported."""


def find_audio_beats(onsets: Onsets, tempo: float | None = None) -> Beats:
    """The beats of a recording, in seconds from its beginning; none if there is no pulse.

    tempo: beats per minute, if it is known; then only the times of the beats are searched.
    """
    period, confidence = (60.0 * RATE / tempo, 1.0) if tempo else _choose_period(onsets)
    if confidence < MIN_CONFIDENCE:
        return no_beats(confidence)
    beats = _tracked(onsets.strength, period)
    if len(beats) < MIN_BEATS:
        return no_beats()
    found = 60.0 * RATE / float(np.median(np.diff(beats)))
    source = BeatSource.TEMPO if tempo else BeatSource.AUDIO
    return Beats(beats / RATE, tempo or found, confidence, source)


def _choose_period(onsets: Onsets) -> tuple[float, float]:
    """The period of the beat in frames, and the confidence, 0..1, that there is a beat."""
    part = _middle(onsets)
    correlations = _WindowCorrelations.of(part.strength)
    best, found = (0.0, 0.0), -np.inf
    shortest, longest = 60.0 * RATE / MAX_TEMPO, 60.0 * RATE / MIN_TEMPO
    for period in likely_periods(part.strength, shortest, longest, MAX_PERIODS):
        beats = _tracked(part.strength, period)
        if len(beats) < MIN_BEATS:
            continue
        pulse = correlations.pulse(beats)
        score = PULSE_WEIGHT * pulse + _plausibility(part, beats)
        if score > found:
            best, found = (period, pulse), score
    period, pulse = best
    chance = CHANCE_PULSE[0] + CHANCE_PULSE[1] / np.sqrt(max(len(correlations.windows), 1))
    return period, float(np.clip((pulse - chance) / CLEAR_PULSE, 0.0, 1.0))


def _middle(onsets: Onsets) -> Onsets:
    """The part from which the tempo is chosen."""
    spare = max(0, len(onsets.strength) - round(MAX_SECONDS * RATE)) // 2
    part = slice(spare, len(onsets.strength) - spare)
    return replace(
        onsets, strength=onsets.strength[part], rise=onsets.rise[part], bass=onsets.bass[part]
    )


@dataclass(frozen=True, slots=True)
class _WindowCorrelations:
    """For each window its first frame and the autocorrelation (lags,) of the onsets in it."""

    windows: tuple[tuple[int, FloatArray], ...]

    @classmethod
    def of(cls, strength: FloatArray) -> _WindowCorrelations:
        width = round(WINDOW * RATE)
        starts = range(0, max(1, len(strength) - width // 2), width // 2)
        parts = ((start, strength[start : start + width]) for start in starts)
        return cls(tuple((start, autocorrelation(part)) for start, part in parts if part.any()))

    def pulse(self, beats: IntArray) -> float:
        """How well the onsets repeat after one to four beats: the median over windows, up to 1.

        beats: frames.
        """
        width = round(WINDOW * RATE)
        pulses: list[float] = []
        for start, correlation in self.windows:
            inside = beats[(beats >= start) & (beats < start + width)]
            if len(inside) > 2:
                pulses.append(_repetition(correlation, float(np.median(np.diff(inside)))))
        return float(np.median(pulses)) if pulses else 0.0


def _repetition(correlation: FloatArray, period: float) -> float:
    peaks = []
    for multiple in range(1, MULTIPLES + 1):
        first = int(multiple * period * (1 - DRIFT))
        last = int(np.ceil(multiple * period * (1 + DRIFT)))
        peaks.append(float(correlation[first : last + 1].max(initial=0.0)))
    return float(np.mean(peaks))


def _tracked(strength: FloatArray, period: float) -> IntArray:
    return _trimmed(track(strength, period, TIGHTNESS), strength)


def _trimmed(beats: IntArray, strength: FloatArray) -> IntArray:
    """`beats` without those before the first onset and after the last one."""
    if not len(beats):
        return beats
    pulses = np.flatnonzero(_at(strength, beats) > 0.5 * strength.std())
    return beats[pulses[0] : pulses[-1] + 1] if len(pulses) else beats[:0]


def _at(curve: FloatArray, beats: IntArray) -> FloatArray:
    """(b,) the largest value of the curve near each of `beats` (b,)."""
    return np.asarray(scipy.ndimage.maximum_filter1d(curve, 2 * MAX_ONSET_DISTANCE + 1)[beats])


def _plausibility(onsets: Onsets, beats: IntArray) -> float:
    octaves = np.log2(60.0 * RATE / float(np.median(np.diff(beats))) / USUAL_TEMPO)
    similarity = RISE_WEIGHT * _similarity(onsets.rise, beats) + BASS_WEIGHT * _similarity(
        onsets.bass, beats
    )
    return float(TEMPO_WEIGHT * octaves**2 + similarity)


def _similarity(curve: FloatArray, beats: IntArray) -> float:
    """The logarithm of the ratio of the weaker to the stronger of odd and even beats; 0 if equal.

    curve: (n,). beats: frames.
    """
    here = _at(curve, beats)
    odd, even = float(here[1::2].mean()), float(here[::2].mean())
    floor = 1e-3 * float(curve.max(initial=0.0)) + 1e-12
    return float(np.log((min(odd, even) + floor) / (max(odd, even) + floor)))
