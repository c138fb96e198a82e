"""The beats that a recording may have, the likeliest ones first. The tempo may drift.

Onset strength (`onsets`) repeats with each beat, but also with each bar and each half beat. So
every plausible tempo is tracked by dynamic programming (Ellis 2007, "Beat tracking by dynamic
programming"), and the middles between its beats are tried too: in much music more begins between
the beats than on them. Likely beats have a tempo that people usually play, are strong and similar,
and have the rises and the bass on them, not between them. Which of the beats are danced, only the
motion shows (`danced_beats`).
"""

from __future__ import annotations

from collections.abc import Iterator
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

SCORE_WEIGHTS = (-1.79, 0.92, 0.91, -0.43, 6.40, 0.24, 0.20)
"""Weights of the numbers of `_evidence`. They come from a multinomial logit on the twelve pieces of
music with true beats and on 70 pieces of the demo's styles. With each style left out in turn, F is
.82 on the twelve pieces (the weights that knew no phase: .65)."""

MAX_HEARD = 20
"""The most beats that are reported."""

SAME_TIME, SAME_SHARE = 0.05, 0.9
"""Seconds and share. Beats of which this share is this close to other beats are the same."""

MAX_ONSET_DISTANCE = 3
"""Frames around a beat in which its onset may be."""

MAX_SECONDS = 90.0
"""The beats are judged in at most this long a part in the middle of the recording."""

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


@dataclass(frozen=True, slots=True)
class HeardBeats:
    """Beats that a recording may have.

    beats: in seconds from its beginning. Their confidence is that the recording has a pulse, not
    that these are its beats. score: of two, the one with the higher score is likelier.
    """

    beats: Beats
    score: float


def find_audio_beats(onsets: Onsets, tempo: float | None = None) -> Beats:
    """The likeliest beats of a recording, in seconds from its beginning; none without a pulse.

    tempo: beats per minute, if it is known; then only the times of the beats are searched.
    """
    heard = heard_beats(onsets, tempo)
    return heard[0].beats if heard else no_beats()


def heard_beats(onsets: Onsets, tempo: float | None = None) -> tuple[HeardBeats, ...]:
    """The beats that a recording may have, the likeliest first; empty if it has no pulse.

    tempo: beats per minute, if it is known; then only the phase of the beats is open.
    """
    part = _middle(onsets)
    windows = _WindowCorrelations.of(part.strength)
    judged = sorted(_judged(part, windows, tempo), key=lambda one: -one.score)
    if not judged:
        return ()
    confidence = 1.0 if tempo else _confidence(judged[0].pulse, len(windows.windows))
    if confidence < MIN_CONFIDENCE:
        return ()
    source = BeatSource.TEMPO if tempo else BeatSource.AUDIO
    heard = []
    for one in _distinct(judged)[:MAX_HEARD]:
        beats = one.beats if part is onsets else _tracked(onsets.strength, one.period, one.between)
        if len(beats) >= MIN_BEATS:
            found = tempo or 60.0 * RATE / float(np.median(np.diff(beats)))
            heard.append(HeardBeats(Beats(beats / RATE, found, confidence, source), one.score))
    return tuple(heard)


@dataclass(frozen=True, slots=True)
class _Judged:
    """Beats (b,) in frames, how they were tracked, how well the onsets repeat, and their score."""

    beats: IntArray
    period: float
    between: bool
    pulse: float
    score: float


def _judged(part: Onsets, windows: _WindowCorrelations, tempo: float | None) -> Iterator[_Judged]:
    shortest, longest = 60.0 * RATE / MAX_TEMPO, 60.0 * RATE / MIN_TEMPO
    periods = (
        [60.0 * RATE / tempo]
        if tempo
        else likely_periods(part.strength, shortest, longest, MAX_PERIODS)
    )
    for period in periods:
        for between in (False, True):
            beats = _tracked(part.strength, period, between)
            if len(beats) >= MIN_BEATS:
                pulse = windows.pulse(beats)
                score = float(np.dot(SCORE_WEIGHTS, _evidence(part, beats, pulse)))
                yield _Judged(beats, period, between, pulse, score)


def _distinct(judged: list[_Judged]) -> list[_Judged]:
    """Those of `judged`, the best first, that are not nearly the same as a better one."""
    kept: list[_Judged] = []
    for one in judged:
        if not any(_are_same(one.beats, other.beats) for other in kept):
            kept.append(one)
    return kept


def _are_same(some: IntArray, others: IntArray) -> bool:
    def covered(these: IntArray, by: IntArray) -> float:
        return float((np.abs(these[:, None] - by).min(axis=1) <= SAME_TIME * RATE).mean())

    return min(covered(some, others), covered(others, some)) >= SAME_SHARE


def _confidence(pulse: float, windows: int) -> float:
    """The confidence, 0..1, that there is a beat."""
    chance = CHANCE_PULSE[0] + CHANCE_PULSE[1] / np.sqrt(max(windows, 1))
    return float(np.clip((pulse - chance) / CLEAR_PULSE, 0.0, 1.0))


def _middle(onsets: Onsets) -> Onsets:
    """The part in which the beats are judged."""
    spare = max(0, len(onsets.strength) - round(MAX_SECONDS * RATE)) // 2
    if not spare:
        return onsets
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


def _tracked(strength: FloatArray, period: float, between: bool) -> IntArray:
    """The beats of about `period` frames, or the middles between them."""
    beats = _trimmed(track(strength, period, TIGHTNESS), strength)
    return _middles(beats) if between else beats


def _middles(beats: IntArray) -> IntArray:
    return np.round(0.5 * (beats[1:] + beats[:-1])).astype(np.int64)


def _trimmed(beats: IntArray, strength: FloatArray) -> IntArray:
    """`beats` without those before the first onset and after the last one."""
    if not len(beats):
        return beats
    pulses = np.flatnonzero(_at(strength, beats) > 0.5 * strength.std())
    return beats[pulses[0] : pulses[-1] + 1] if len(pulses) else beats[:0]


def _at(curve: FloatArray, beats: IntArray) -> FloatArray:
    """(b,) the largest value of the curve near each of `beats` (b,)."""
    return np.asarray(scipy.ndimage.maximum_filter1d(curve, 2 * MAX_ONSET_DISTANCE + 1)[beats])


def _evidence(onsets: Onsets, beats: IntArray, pulse: float) -> tuple[float, ...]:
    """What speaks for `beats` (b,), in frames; see SCORE_WEIGHTS.

    The distance from USUAL_TEMPO in octaves, squared and not; how similar the rise is at odd and
    even beats, and the bass; the pulse; how much more bass and rise there is on the beats than
    between them (natural logarithms of ratios).
    """
    octaves = np.log2(60.0 * RATE / float(np.median(np.diff(beats))) / USUAL_TEMPO)
    between = _middles(beats)
    return (
        float(octaves**2),
        float(octaves),
        -abs(_contrast(onsets.rise, beats[1::2], beats[::2])),
        -abs(_contrast(onsets.bass, beats[1::2], beats[::2])),
        pulse,
        *(_contrast(curve, beats, between) for curve in (onsets.bass, onsets.rise)),
    )


def _contrast(curve: FloatArray, here: IntArray, there: IntArray) -> float:
    """The logarithm of the ratio of the curve's means near frames `here` and near `there`."""
    floor = 1e-3 * float(curve.max(initial=0.0)) + 1e-12
    ratio = (float(_at(curve, here).mean()) + floor) / (float(_at(curve, there).mean()) + floor)
    return float(np.log(ratio))
