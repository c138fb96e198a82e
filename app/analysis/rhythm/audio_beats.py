"""The beats that a recording may have, the likeliest ones first. The tempo may drift.

librosa finds the tempo and the beats (Ellis 2007, "Beat tracking by dynamic programming"). Onsets
repeat with each beat, but also with each bar and each half beat, so librosa's tempo may be a simple
ratio of that of the beats. librosa therefore also tracks the RATIOS of its tempo, and the middles
between all these beats are tried: in much music more begins between the beats than on them. Likely
beats are those of librosa, have a tempo that people usually play, and have the rises and the bass
on them, not between them. Which of the beats are danced, only the motion shows (`danced_beats`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import scipy

from app.analysis.rhythm.beat_tracking import MIN_BEATS, MULTIPLES, autocorrelation
from app.analysis.rhythm.beats import Beats, BeatSource, no_beats
from app.analysis.rhythm.onsets import HOP, RATE, SAMPLE_RATE, Onsets, library
from app.numerics.arrays import FloatArray, IntArray

MIN_TEMPO, MAX_TEMPO = 40.0, 220.0
"""Beats per minute."""

RATIOS = (1.0, 1 / 3, 1 / 2, 2 / 3, 3 / 4, 4 / 3, 3 / 2, 2.0, 3.0)
"""The ratios of librosa's tempo that are tracked."""

TIGHTNESS = 200.0
"""How evenly librosa's beats follow each other; its default, 100, leaves the beats of a slowly
drifting piece (F on the twelve recorded pieces .93 for .94)."""

LATER = 0.5
"""Frames (12 ms) that are added to beats. Onsets come 24 ms early for clicks, 13 ms for the demo's
music and 5 ms for recorded music (see `onsets`)."""

USUAL_TEMPO = 112.0
"""Beats per minute of most music (McKinney & Moelants 2006: 100 to 140)."""

SCORE_WEIGHTS = (-1.28, 0.92, 0.44, 0.22, -1.02, 1.29, 1.50)
"""Weights of the numbers of `_evidence`. They come from a multinomial logit, with twice the sum of
their squares as penalty, on the twelve recorded pieces (three times each) and 42 pieces of the
demo's styles. With each style left out in turn, F, CMLt and AMLt are .99, .98 and .98 on the
recorded pieces, where librosa's own choice has .94, .90 and .90; on the demo's pieces .90, .75 and
.94 (librosa's: .86, .68, .89). On 54 pieces of styles that were not used: .78, .61, .92 (.73, .50,
.76)."""

SAME_TIME, SAME_SHARE = 0.05, 0.9
"""Seconds and share. Beats of which this share is this close to other beats are the same."""

MAX_ONSET_DISTANCE = 1
"""Frames around a beat in which its onset may be."""

MAX_SECONDS = 90.0
"""The tempo is that of at most this long a part in the middle of the recording."""

WINDOW = 8.0
"""Seconds: the windows in which the pulse is measured. They overlap by half."""

DRIFT = 0.04
"""The largest relative difference of a period from the beat within a window."""

CHANCE_PULSE = (0.14, 0.1)
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
    windows = _WindowCorrelations.of(onsets.strength)
    judged = sorted(_judged(onsets, windows, tempo), key=lambda one: -one.score)
    if not judged:
        return ()
    confidence = 1.0 if tempo else _confidence(judged[0].pulse, len(windows.windows))
    if confidence < MIN_CONFIDENCE:
        return ()
    source = BeatSource.TEMPO if tempo else BeatSource.AUDIO
    heard = []
    for one in _distinct(judged):
        # frames are coarse, so the mean interval is more exact than the median one
        found = tempo or 60.0 * RATE / float(np.diff(one.beats).mean())
        times = (one.beats + LATER) / RATE
        heard.append(HeardBeats(Beats(times, found, confidence, source), one.score))
    return tuple(heard)


@dataclass(frozen=True, slots=True)
class _Judged:
    """Beats (b,) in frames, how well the onsets repeat with them, and their score."""

    beats: IntArray
    pulse: float
    score: float


def _judged(onsets: Onsets, windows: _WindowCorrelations, tempo: float | None) -> Iterator[_Judged]:
    if not onsets.strength.any() or onsets.duration < MIN_BEATS * 60.0 / MAX_TEMPO:
        return
    own = _tempo(onsets.strength)
    for bpm in [tempo] if tempo else [own * ratio for ratio in RATIOS]:
        if tempo or MIN_TEMPO <= bpm <= MAX_TEMPO:
            tracked = _tracked(onsets.strength, bpm)
            for beats in (tracked, _middles(tracked)):
                if len(beats) >= MIN_BEATS:
                    is_own = beats is tracked and bpm in (own, tempo)
                    score = float(np.dot(SCORE_WEIGHTS, _evidence(onsets, beats, is_own=is_own)))
                    yield _Judged(beats, windows.pulse(beats), score)


def _tempo(strength: FloatArray) -> float:
    """librosa's tempo, in beats per minute, of the middle of the recording."""
    spare = max(0, len(strength) - round(MAX_SECONDS * RATE)) // 2
    middle = strength[spare : len(strength) - spare]
    found = library().feature.tempo(onset_envelope=middle, sr=SAMPLE_RATE, hop_length=HOP)
    return float(found[0])


def _tracked(strength: FloatArray, bpm: float) -> IntArray:
    """librosa's beats (b,) of about `bpm` per minute, in frames."""
    _, beats = library().beat.beat_track(
        onset_envelope=strength, sr=SAMPLE_RATE, hop_length=HOP, bpm=bpm, tightness=TIGHTNESS
    )
    return np.asarray(beats, dtype=np.int64)


def _middles(beats: IntArray) -> IntArray:
    return np.round(0.5 * (beats[1:] + beats[:-1])).astype(np.int64)


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


def _at(curve: FloatArray, beats: IntArray) -> FloatArray:
    """(b,) the largest value of the curve near each of `beats` (b,)."""
    return np.asarray(scipy.ndimage.maximum_filter1d(curve, 2 * MAX_ONSET_DISTANCE + 1)[beats])


def _evidence(onsets: Onsets, beats: IntArray, *, is_own: bool) -> tuple[float, ...]:
    """What speaks for `beats` (b,), in frames; see SCORE_WEIGHTS.

    The distance from USUAL_TEMPO in octaves, squared and not; how much more bass, rise and onset
    strength there is on the beats than between them (natural logarithms of ratios); whether they
    are librosa's own; the onset strength on them, in units of its standard deviation.
    """
    octaves = np.log2(60.0 * RATE / float(np.median(np.diff(beats))) / USUAL_TEMPO)
    between = _middles(beats)
    return (
        float(octaves**2),
        float(octaves),
        *(
            _contrast(curve, beats, between)
            for curve in (onsets.bass, onsets.rise, onsets.strength)
        ),
        float(is_own),
        float(onsets.strength[beats].mean() / onsets.strength.std()),
    )


def _contrast(curve: FloatArray, here: IntArray, there: IntArray) -> float:
    """The logarithm of the ratio of the curve's means near frames `here` and near `there`."""
    floor = 1e-3 * float(curve.max(initial=0.0)) + 1e-12
    ratio = (float(_at(curve, here).mean()) + floor) / (float(_at(curve, there).mean()) + floor)
    return float(np.log(ratio))
