"""The audio recording of a dance, and the time of the motion at which it begins.

Music has a quiet introduction before the dance, is quiet when the dancer freezes, and ends with the
dance. A metronome has the same loudness all the time.
"""

from __future__ import annotations

from enum import StrEnum

import numpy as np

from app.demo.dances.counts import Counts
from app.demo.dances.music import STYLES, clicks, music
from app.demo.dances.sounds import SAMPLE_RATE
from app.demo.dances.wav import write_wav
from app.numerics.arrays import FloatArray

MIN_START, MAX_START = -5.0, 1.0
"""The range of the time of the motion, in seconds, at which a recording begins."""

SECONDS_AFTER = (0.5, 3.0)
"""The range of the time for which it continues after the motion."""

INTRODUCTION_LEVEL, FREEZE_LEVEL = 0.45, 0.3
"""The loudness, 0..1; see `music`."""


class Sound(StrEnum):
    """The kind of a recording."""

    CLICKS = "clicks"
    MUSIC = "music"


def record(
    seed: int, sound: Sound, counts: Counts, duration: float, offset: float | None
) -> tuple[bytes, float]:
    """A WAV file, and the time of the motion, in seconds, at which it begins.

    duration: that of the motion, s. offset: the beginning; None draws one.
    """
    draw = np.random.RandomState(seed + 500_000)
    drawn, after = draw.uniform(MIN_START, MAX_START), draw.uniform(*SECONDS_AFTER)
    start = float(round(drawn, 3)) if offset is None else offset
    seconds = duration + after - start
    beats = _all_beats(counts, start, start + seconds)
    if sound is Sound.CLICKS:
        samples = clicks(draw, beats - start, seconds)
    else:
        style = str(draw.choice(sorted(STYLES)))
        samples = music(draw, beats - start, seconds, STYLES[style], _levels(counts, beats))
    return write_wav(samples, SAMPLE_RATE), start


def _all_beats(counts: Counts, start: float, stop: float) -> FloatArray:
    """(b,) all beats from `start` to `stop`, in seconds.

    They continue evenly before and after the dance.
    """
    first, last = np.diff(counts.beats)[[0, -1]]
    before = np.arange(counts.beats[0] - first, start, -first)[::-1]
    after = np.arange(counts.beats[-1] + last, stop, last)
    every = np.concatenate([before, counts.beats, after])
    return np.asarray(every[every >= start])


def _levels(counts: Counts, beats: FloatArray) -> FloatArray:
    """(b,) the loudness of the music from each of `beats` (b,) s on."""
    held = counts.held
    levels = np.where(beats < held[0].time - 0.5 * counts.interval, INTRODUCTION_LEVEL, 1.0)
    levels[beats > held[-1].time + 0.5 * counts.interval] = 0.0
    for moment in held[:-1]:
        if moment.leave - moment.arrive > counts.interval:
            within = (beats > moment.arrive) & (beats < moment.leave)
            levels[within] = FREEZE_LEVEL
    return np.asarray(levels)
