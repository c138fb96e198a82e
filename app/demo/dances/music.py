"""Music for a dance: drums, bass, chords and a tune on given beats, or a metronome's clicks.

Beats may drift; everything between them is placed by fractions of a beat. Styles differ in
what marks the beat: some have every beat drummed, some only every other, some nothing but
chords and bass.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.demo.dances import sounds
from app.demo.dances.sounds import SAMPLE_RATE, note, put
from app.numerics.arrays import FloatArray

Pattern = tuple[tuple[float, float], ...]
"""(beat within the bar, gain)."""


@dataclass(frozen=True, slots=True)
class Style:
    """bar: beats; when drums, bass and chords sound; swing: lateness of the second half beat, in
    beats; attack: seconds in which chords swell."""

    bar: int
    kicks: Pattern
    snares: Pattern
    hats: Pattern
    bass: Pattern
    chords: Pattern
    swing: float = 0.0
    attack: float = 0.02


def every(step: float, bar: int = 4, gain: float = 1.0, start: float = 0.0) -> Pattern:
    """A note each `step` beats of a bar, from `start` on."""
    return tuple((float(at), gain) for at in np.arange(start, bar, step))


_BACKBEAT: Pattern = ((1, 1.0), (3, 1.0))

STYLES: dict[str, Style] = {
    "rock": Style(
        4, ((0, 1.0), (2, 0.9), (2.5, 0.5)), _BACKBEAT, every(0.5), every(0.5), every(2)
    ),
    "disco": Style(
        4, every(1), _BACKBEAT, every(1, start=0.5), every(0.5, gain=0.8), ((0, 1), (1.5, 0.6))
    ),
    "swing": Style(
        4, every(1, gain=0.5), ((1, 0.5), (3, 0.5)), (*every(1), (1.5, 0.7), (3.5, 0.7)),
        every(1), ((0, 1.0), (1.5, 0.7)), swing=1 / 6,
    ),
    "latin": Style(
        4, ((0, 1.0), (1.5, 0.6), (2, 0.7), (3.5, 0.6)),
        ((0, 0.5), (0.75, 0.6), (1.5, 0.6), (2.5, 0.6), (3, 0.5)), every(0.5, gain=0.7),
        ((0, 1.0), (1.5, 0.9), (3, 0.9)), ((0, 0.8), (1, 0.5), (1.5, 0.5), (3, 0.6)),
    ),
    "waltz": Style(
        3, ((0, 1.0),), ((1, 0.4), (2, 0.4)), ((1, 0.6), (2, 0.6)), ((0, 1.0),),
        ((0, 0.5), (1, 0.9), (2, 0.9)),
    ),
    "march": Style(
        4, ((0, 1.0), (2, 1.0)), ((1, 0.9), (3, 0.9), (3.5, 0.5)), (), every(1), every(1)
    ),
    "ballad": Style(
        4, (), (), (), ((0, 1.0), (2, 0.8)), (*every(1, gain=0.8), (2.5, 0.4))
    ),
}  # fmt: skip

PROGRESSIONS: tuple[tuple[int, ...], ...] = ((0, -3, 5, 7), (0, 5, 7, 0), (0, 7, -3, 5))
"""Semitones of the chords' roots above the key, a bar each."""

SCALE = (0, 2, 4, 7, 9, 12)
"""Semitones of the tune."""

LOUDEST = 0.8
HISS = 0.002
"""The noise of a recording, as a share of full scale."""


def clicks(draw: np.random.RandomState, beats: FloatArray, seconds: float) -> FloatArray:
    """(samples,) a metronome on `beats` (b,) s; every fourth click may be higher."""
    track = np.zeros(round(seconds * SAMPLE_RATE))
    accented = draw.rand() < 0.5
    for number, beat in enumerate(beats):
        high = accented and number % 4 == 0
        put(track, sounds.click(1500.0 if high else 1000.0), float(beat), 1.0)
    return _mastered(draw, track)


def music(
    draw: np.random.RandomState,
    beats: FloatArray,
    seconds: float,
    style: Style,
    levels: FloatArray | None = None,
) -> FloatArray:
    """(samples,) a piece on `beats` (b,) s.

    levels: (b,) 0..1, how full the band is from each beat on: 0 is silence, below a half there
    are no drums.
    """
    track = np.zeros(round(seconds * SAMPLE_RATE))
    full = np.ones(len(beats)) if levels is None else levels
    _drums(draw, track, beats, full, style)
    _tones(draw, track, beats, full, style)
    return _mastered(draw, track)


def _drums(
    draw: np.random.RandomState,
    track: FloatArray,
    beats: FloatArray,
    full: FloatArray,
    style: Style,
) -> None:
    kit = (
        (style.kicks, sounds.kick(), 0.9 * draw.uniform(0.6, 1.0)),
        (style.snares, sounds.snare(draw), 0.6 * draw.uniform(0.6, 1.0)),
        (style.hats, sounds.hat(draw, draw.uniform(0.02, 0.06)), 0.35 * draw.uniform(0.5, 1.0)),
    )
    for pattern, sound, loud in kit:
        for number, at, gain in _played(pattern, style, len(beats)):
            if full[number] >= 0.5:
                touch = loud * gain * draw.uniform(0.85, 1.0) * full[number]
                put(track, sound, _time(beats, at, style.swing) + 0.004 * draw.randn(), touch)


def _tones(
    draw: np.random.RandomState,
    track: FloatArray,
    beats: FloatArray,
    full: FloatArray,
    style: Style,
) -> None:
    """Bass, chords, and a tune that rests now and then."""
    key, roots = 45 + draw.randint(8), PROGRESSIONS[draw.randint(len(PROGRESSIONS))]
    beat = float(np.median(np.diff(beats)))
    third = draw.choice([3, 4])
    for number, at, gain in _played(style.bass, style, len(beats)):
        pitch = note(key - 12 + roots[number // style.bar % len(roots)])
        sound = sounds.tone(pitch, 0.8 * beat, attack=0.01, decay=0.4, bright=5)
        put(track, sound, _time(beats, at, style.swing), 0.5 * gain * full[number])
    for number, at, gain in _played(style.chords, style, len(beats)):
        root = key + 12 + roots[number // style.bar % len(roots)]
        for step in (0, third, 7):
            pitch, held = note(root + step), 1.1 * beat
            sound = sounds.tone(pitch, held, attack=style.attack, decay=0.5, bright=4)
            put(track, sound, _time(beats, at, style.swing), 0.16 * gain * full[number])
    for half in range(2 * len(beats)):
        if draw.rand() < 0.35:
            pitch = note(key + 24 + SCALE[draw.randint(len(SCALE))])
            sound = sounds.tone(pitch, 0.7 * beat, attack=0.03, decay=0.3, bright=3)
            put(track, sound, _time(beats, 0.5 * half, style.swing), 0.2 * full[half // 2])


def _played(pattern: Pattern, style: Style, beats: int) -> list[tuple[int, float, float]]:
    """(beat's number, time in beats, gain) of all that a pattern plays on that many beats."""
    notes = []
    for bar in range(0, beats, style.bar):
        for at, gain in pattern:
            if bar + at < beats:
                notes.append((int(bar + at), bar + at, gain))
    return notes


def _time(beats: FloatArray, at: float, swing: float) -> float:
    """Seconds of a moment in beats; the second half of a beat comes later by `swing`."""
    late = swing if at % 1.0 == 0.5 else 0.0
    numbers = np.arange(len(beats) + 1)
    ends = np.append(beats, 2 * beats[-1] - beats[-2])
    return float(np.interp(at + late, numbers, ends))


def _mastered(draw: np.random.RandomState, track: FloatArray) -> FloatArray:
    peak = float(np.abs(track).max(initial=1e-9))
    return np.asarray(np.tanh(1.2 * track / peak) * LOUDEST + HISS * draw.randn(len(track)))
