"""The recording of what a dance is danced to, with the time at which it begins in the motion.

Music is arranged as for a stage: an introduction until the dance begins, a band that falls
back where the dancer freezes, an end with the dance. A metronome just goes on.
"""

from __future__ import annotations

from enum import StrEnum

import numpy as np

from app.demo.dances.counts import Counts
from app.demo.dances.music import STYLES, clicks, music
from app.demo.dances.sounds import SAMPLE_RATE
from app.demo.dances.wav import write_wav
from app.numerics.arrays import FloatArray

EARLIEST, LATEST = -5.0, 1.0
"""Seconds of the motion at which a recording begins."""

AFTERWARDS = (0.5, 3.0)
"""Seconds that it goes on after the motion."""

INTRODUCTION, BREAK = 0.45, 0.3
"""How full the band is; see `music`."""


class Sound(StrEnum):
    """What there is to dance to."""

    CLICKS = "clicks"
    MUSIC = "music"


def record(
    seed: int, sound: Sound, counts: Counts, duration: float, offset: float | None
) -> tuple[bytes, float]:
    """A WAV file, and the time of the motion (s) at which it begins, drawn where None.

    duration: of the motion, s.
    """
    draw = np.random.RandomState(seed + 500_000)
    drawn, after = draw.uniform(EARLIEST, LATEST), draw.uniform(*AFTERWARDS)
    start = float(round(drawn, 3)) if offset is None else offset
    seconds = duration + after - start
    beats = _throughout(counts, start, start + seconds)
    if sound is Sound.CLICKS:
        samples = clicks(draw, beats - start, seconds)
    else:
        style = str(draw.choice(sorted(STYLES)))
        samples = music(draw, beats - start, seconds, STYLES[style], _levels(counts, beats))
    return write_wav(samples, SAMPLE_RATE), start


def _throughout(counts: Counts, start: float, stop: float) -> FloatArray:
    """All beats from `start` to `stop`, going on evenly on both sides of the dance's."""
    first, last = np.diff(counts.beats)[[0, -1]]
    before = np.arange(counts.beats[0] - first, start, -first)[::-1]
    after = np.arange(counts.beats[-1] + last, stop, last)
    every = np.concatenate([before, counts.beats, after])
    return np.asarray(every[every >= start])


def _levels(counts: Counts, beats: FloatArray) -> FloatArray:
    """(b,) how full the band is from each beat on."""
    held = counts.held
    levels = np.where(beats < held[0].time - 0.5 * counts.interval, INTRODUCTION, 1.0)
    levels[beats > held[-1].time + 0.5 * counts.interval] = 0.0
    for moment in held[:-1]:
        if moment.leave - moment.arrive > counts.interval:
            within = (beats > moment.arrive) & (beats < moment.leave)
            levels[within] = BREAK
    return np.asarray(levels)
