"""Sounds from which recordings are rendered: drums, plucked and held tones, clicks.

Each is (samples,) floats of about 1 at their loudest, mono at SAMPLE_RATE.
"""

from __future__ import annotations

import numpy as np

from app.numerics.arrays import FloatArray

SAMPLE_RATE = 22050
"""Hz."""


def click(pitch: float = 1000.0) -> FloatArray:
    """A metronome's tick of 30 ms."""
    t = _clock(0.03)
    return np.asarray(np.sin(2 * np.pi * pitch * t) * np.exp(-t / 0.006))


def kick() -> FloatArray:
    """A bass drum: a tone falling from 150 to 50 Hz."""
    t = _clock(0.25)
    return np.asarray(np.sin(2 * np.pi * (50 * t - 4.0 * np.exp(-t / 0.04))) * np.exp(-t / 0.08))


def snare(draw: np.random.RandomState) -> FloatArray:
    """A snare drum: noise over a short tone."""
    t = _clock(0.2)
    noise = 0.7 * draw.uniform(-1, 1, len(t)) * np.exp(-t / 0.06)
    return np.asarray(noise + 0.4 * np.sin(2 * np.pi * 185 * t) * np.exp(-t / 0.04))


def hat(draw: np.random.RandomState, length: float = 0.03) -> FloatArray:
    """A hi-hat: bright noise; `length` s is its decay."""
    t = _clock(5 * length)
    noise = np.diff(draw.uniform(-1, 1, len(t) + 1))
    return np.asarray(0.5 * noise * np.exp(-t / length))


def tone(pitch: float, seconds: float, *, attack: float, decay: float, bright: int) -> FloatArray:
    """A tone of `bright` harmonics that swells in `attack` s and dies away with `decay` s."""
    t = _clock(seconds)
    harmonics = np.arange(1, bright + 1)
    wave = np.sin(2 * np.pi * pitch * np.outer(t, harmonics)) @ (1.0 / harmonics)
    swell = np.minimum(t / attack, 1.0) * np.minimum((seconds - t) / 0.02, 1.0)
    return np.asarray(0.6 * wave * swell * np.exp(-t / decay))


def note(number: float) -> float:
    """Frequency (Hz) of a MIDI note; 69 is 440 Hz."""
    return float(440.0 * 2.0 ** ((number - 69.0) / 12.0))


def put(track: FloatArray, sound: FloatArray, time: float, gain: float) -> None:
    """Add a sound to `track` at `time` s, as much of it as lies within."""
    start = round(time * SAMPLE_RATE)
    first, stop = max(start, 0), min(start + len(sound), len(track))
    if first < stop:
        track[first:stop] += gain * sound[first - start : stop - start]


def _clock(seconds: float) -> FloatArray:
    return np.arange(max(1, round(seconds * SAMPLE_RATE))) / SAMPLE_RATE
