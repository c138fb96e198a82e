"""The sounds of recordings: drums, tones and clicks.

Each sound is a mono array (samples,) at SAMPLE_RATE. Its loudest sample is about 1.
"""

from __future__ import annotations

import numpy as np

from app.numerics.arrays import FloatArray

SAMPLE_RATE = 22050
"""Hz."""


def click(pitch: float = 1000.0) -> FloatArray:
    """A click of a metronome, 30 ms; pitch: Hz."""
    t = _clock(0.03)
    return np.asarray(np.sin(2 * np.pi * pitch * t) * np.exp(-t / 0.006))


def kick() -> FloatArray:
    """A bass drum: a tone whose frequency falls from 150 to 50 Hz."""
    t = _clock(0.25)
    return np.asarray(np.sin(2 * np.pi * (50 * t - 4.0 * np.exp(-t / 0.04))) * np.exp(-t / 0.08))


def snare(draw: np.random.RandomState) -> FloatArray:
    """A snare drum: noise and a short tone."""
    t = _clock(0.2)
    noise = 0.7 * draw.uniform(-1, 1, len(t)) * np.exp(-t / 0.06)
    return np.asarray(noise + 0.4 * np.sin(2 * np.pi * 185 * t) * np.exp(-t / 0.04))


def hat(draw: np.random.RandomState, length: float = 0.03) -> FloatArray:
    """A hi-hat: noise of high frequencies; length: the seconds of its decay."""
    t = _clock(5 * length)
    # differences of white noise have mostly high frequencies
    noise = np.diff(draw.uniform(-1, 1, len(t) + 1))
    return np.asarray(0.5 * noise * np.exp(-t / length))


def tone(pitch: float, seconds: float, *, attack: float, decay: float, bright: int) -> FloatArray:
    """A tone of `pitch` Hz with `bright` harmonics; attack, decay: seconds."""
    t = _clock(seconds)
    harmonics = np.arange(1, bright + 1)
    wave = np.sin(2 * np.pi * pitch * np.outer(t, harmonics)) @ (1.0 / harmonics)
    swell = np.minimum(t / attack, 1.0) * np.minimum((seconds - t) / 0.02, 1.0)
    return np.asarray(0.6 * wave * swell * np.exp(-t / decay))


def note(number: float) -> float:
    """The frequency (Hz) of a MIDI note. Note 69 is 440 Hz."""
    return float(440.0 * 2.0 ** ((number - 69.0) / 12.0))


def put(track: FloatArray, sound: FloatArray, time: float, gain: float) -> None:
    """Add a sound to `track` (samples,) at `time` s. Parts outside the track are cut off."""
    start = round(time * SAMPLE_RATE)
    first, stop = max(start, 0), min(start + len(sound), len(track))
    if first < stop:
        track[first:stop] += gain * sound[first - start : stop - start]


def _clock(seconds: float) -> FloatArray:
    return np.arange(max(1, round(seconds * SAMPLE_RATE))) / SAMPLE_RATE
