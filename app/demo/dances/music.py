"""Music for a dance: drums, bass, chords and a tune on given beats, or clicks of a metronome.

The tempo may drift; the times of notes between two beats are fractions of the interval. Styles mark
the beat in different ways: with a drum on each beat, on every second beat, or only with chords and
bass.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.demo.dances import sounds
from app.demo.dances.sounds import SAMPLE_RATE, note, put
from app.numerics.arrays import FloatArray

Pattern = tuple[tuple[float, float], ...]
"""Pairs of a beat within the bar and a gain."""


@dataclass(frozen=True, slots=True)
class Style:
    """A style of music: the patterns of the instruments.

    bar: its beats. swing: the delay of the second half of a beat, in beats. attack: seconds in
    which chords become loud.
    """

    bar: int
    kicks: Pattern
    snares: Pattern
    hats: Pattern
    bass: Pattern
    chords: Pattern
    swing: float = 0.0
    attack: float = 0.02


def every(step: float, bar: int = 4, gain: float = 1.0, start: float = 0.0) -> Pattern:
    """A pattern with a note every `step` beats of a bar, from the beat `start` on."""
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
"""The roots of the chords, one for each bar, in semitones above the key."""

SCALE = (0, 2, 4, 7, 9, 12)
"""The notes of the tune, in semitones above the key."""

PEAK_LEVEL = 0.8
"""The loudest sample, as a share of full scale."""

NOISE_LEVEL = 0.002
"""The noise of a recording, as a share of full scale."""


def clicks(draw: np.random.RandomState, beats: FloatArray, seconds: float) -> FloatArray:
    """(samples,) clicks of a metronome on `beats` (b,) s; every fourth click may be higher."""
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
    """(samples,) a piece of music on `beats` (b,) s, of `seconds`.

    levels: (b,) 0..1, the loudness from each beat on. 0 is silence; below 0.5 there are no drums.
    """
    track = np.zeros(round(seconds * SAMPLE_RATE))
    levels = np.ones(len(beats)) if levels is None else levels
    _add_drums(draw, track, beats, levels, style)
    _add_tones(draw, track, beats, levels, style)
    return _mastered(draw, track)


def _add_drums(
    draw: np.random.RandomState,
    track: FloatArray,
    beats: FloatArray,
    levels: FloatArray,
    style: Style,
) -> None:
    kit = (
        (style.kicks, sounds.kick(), 0.9 * draw.uniform(0.6, 1.0)),
        (style.snares, sounds.snare(draw), 0.6 * draw.uniform(0.6, 1.0)),
        (style.hats, sounds.hat(draw, draw.uniform(0.02, 0.06)), 0.35 * draw.uniform(0.5, 1.0)),
    )
    for pattern, sound, loud in kit:
        for number, at, gain in _played(pattern, style, len(beats)):
            if levels[number] >= 0.5:
                touch = loud * gain * draw.uniform(0.85, 1.0) * levels[number]
                put(track, sound, _time(beats, at, style.swing) + 0.004 * draw.randn(), touch)


def _add_tones(
    draw: np.random.RandomState,
    track: FloatArray,
    beats: FloatArray,
    levels: FloatArray,
    style: Style,
) -> None:
    """Add bass, chords, and a tune with pauses."""
    key, roots = 45 + draw.randint(8), PROGRESSIONS[draw.randint(len(PROGRESSIONS))]
    beat = float(np.median(np.diff(beats)))
    third = draw.choice([3, 4])
    for number, at, gain in _played(style.bass, style, len(beats)):
        pitch = note(key - 12 + roots[number // style.bar % len(roots)])
        sound = sounds.tone(pitch, 0.8 * beat, attack=0.01, decay=0.4, bright=5)
        put(track, sound, _time(beats, at, style.swing), 0.5 * gain * levels[number])
    for number, at, gain in _played(style.chords, style, len(beats)):
        root = key + 12 + roots[number // style.bar % len(roots)]
        for step in (0, third, 7):
            pitch, held = note(root + step), 1.1 * beat
            sound = sounds.tone(pitch, held, attack=style.attack, decay=0.5, bright=4)
            put(track, sound, _time(beats, at, style.swing), 0.16 * gain * levels[number])
    for half in range(2 * len(beats)):
        if draw.rand() < 0.35:
            pitch = note(key + 24 + SCALE[draw.randint(len(SCALE))])
            sound = sounds.tone(pitch, 0.7 * beat, attack=0.03, decay=0.3, bright=3)
            put(track, sound, _time(beats, 0.5 * half, style.swing), 0.2 * levels[half // 2])


def _played(pattern: Pattern, style: Style, beats: int) -> list[tuple[int, float, float]]:
    """The notes of a pattern in `beats` beats: index of the beat, time in beats, gain."""
    notes = []
    for bar in range(0, beats, style.bar):
        for at, gain in pattern:
            if bar + at < beats:
                notes.append((int(bar + at), bar + at, gain))
    return notes


def _time(beats: FloatArray, at: float, swing: float) -> float:
    """The time in seconds of a time in beats; the second half of a beat is later by `swing`."""
    late = swing if at % 1.0 == 0.5 else 0.0
    numbers = np.arange(len(beats) + 1)
    ends = np.append(beats, 2 * beats[-1] - beats[-2])
    return float(np.interp(at + late, numbers, ends))


def _mastered(draw: np.random.RandomState, track: FloatArray) -> FloatArray:
    peak = float(np.abs(track).max(initial=1e-9))
    # tanh compresses the peaks, as a recording does
    return np.asarray(
        np.tanh(1.2 * track / peak) * PEAK_LEVEL + NOISE_LEVEL * draw.randn(len(track))
    )
