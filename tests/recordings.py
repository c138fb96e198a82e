"""Audio recordings for tests: music with known beats, and sounds without beats."""

from __future__ import annotations

import numpy as np

from app.demo.dances import sounds
from app.demo.dances.music import STYLES, clicks, music
from app.demo.dances.sounds import SAMPLE_RATE
from app.numerics.arrays import FloatArray
from tests.held_out_music import HELD_OUT_STYLES

CLICKS = "clicks"


def piece(
    seed: int, style: str, bpm: float, *, drift: float = 0.0, seconds: float = 30.0
) -> tuple[FloatArray, FloatArray]:
    """Samples (n,) at SAMPLE_RATE, and beats (b,) in seconds.

    style: CLICKS or a style of music; bpm: beats per minute; drift: largest relative change of the
    tempo.
    """
    draw = np.random.RandomState(seed)
    beats = beats_at(draw, bpm, seconds, drift)
    if style == CLICKS:
        return clicks(draw, beats, seconds), beats
    return music(draw, beats, seconds, (STYLES | HELD_OUT_STYLES)[style]), beats


def beats_at(draw: np.random.RandomState, bpm: float, seconds: float, drift: float) -> FloatArray:
    first = draw.uniform(0.1, 2.0)
    at = np.linspace(0.0, 1.0, int((seconds - first - 0.5) * bpm / 60.0))
    if draw.rand() < 0.4:
        course = draw.choice([-1.0, 1.0]) * (2 * at - 1)
    else:
        course = np.sin(2 * np.pi * (draw.uniform(0.5, 1.5) * at + draw.rand()))
    intervals = 60.0 / bpm * np.exp(drift * course)
    return np.asarray(first + np.cumsum(intervals) - intervals[0])


def without_beat(seed: int, kind: str, seconds: float = 20.0) -> FloatArray:
    """Samples (n,) at SAMPLE_RATE of a sound without beats; kind: one of WITHOUT_BEAT."""
    draw = np.random.RandomState(seed)
    track = 0.002 * draw.randn(round(seconds * SAMPLE_RATE))
    if kind == "hiss":
        return 50 * track
    if kind == "hum":
        track += 0.1 * np.sin(2 * np.pi * 50 * np.arange(len(track)) / SAMPLE_RATE)
    elif kind == "chords":
        for start in np.arange(0.0, seconds, 4.0):
            for step in (0, 4, 7):
                pitch = sounds.note(50 + step + draw.randint(5))
                tone = sounds.tone(pitch, 6.0, attack=1.0, decay=10.0, bright=5)
                sounds.put(track, tone, start + draw.rand(), 0.2)
    elif kind == "irregular":
        for time in np.cumsum(draw.uniform(0.3, 1.1, 60)):
            sounds.put(track, sounds.kick(), time, draw.uniform(0.3, 1.0))
    elif kind == "speech":
        _speak(draw, track, seconds)
    return track


WITHOUT_BEAT = ("hiss", "hum", "chords", "irregular", "speech")


def _speak(draw: np.random.RandomState, track: FloatArray, seconds: float) -> None:
    """Add syllables of random length and pitch, in phrases, to `track`."""
    time = 0.3
    while time < seconds:
        for _ in range(draw.randint(3, 12)):
            length = draw.uniform(0.08, 0.35)
            pitch, bright = draw.uniform(90, 220), int(draw.randint(4, 12))
            syllable = sounds.tone(pitch, length, attack=0.03, decay=0.3, bright=bright)
            sounds.put(track, syllable, time, draw.uniform(0.3, 1.0))
            time += length * draw.uniform(0.9, 1.4)
        time += draw.uniform(0.2, 1.2)


def f_score(found: FloatArray, true: FloatArray, within: float = 0.07) -> float:
    """F-score of the found beats; found and true beats are matched one to one in time order.

    found, true: (b,) seconds, rising; within: largest difference of a match, seconds.
    """
    hits, taken = 0, 0
    for beat in true:
        while taken < len(found) and found[taken] < beat - within:
            taken += 1
        if taken < len(found) and found[taken] <= beat + within:
            hits, taken = hits + 1, taken + 1
    return 2 * hits / max(len(found) + len(true), 1)
