"""Music for dances has its length, is on its beats, and never exceeds full scale."""

from __future__ import annotations

import io
import wave

import numpy as np
import pytest

from app.demo.dances.music import STYLES, clicks, music
from app.demo.dances.sounds import SAMPLE_RATE
from app.demo.dances.wav import write_wav

BEATS = 0.5 + 0.6 * np.arange(12)


def loudness(samples: np.ndarray, start: float, stop: float) -> float:
    part = samples[round(start * SAMPLE_RATE) : round(stop * SAMPLE_RATE)]
    return float(np.sqrt(np.square(part).mean()))


@pytest.mark.parametrize("style", STYLES)
def test_music_has_its_length_and_its_level(style: str) -> None:
    samples = music(np.random.RandomState(1), BEATS, 9.0, STYLES[style])
    assert len(samples) == 9 * SAMPLE_RATE
    assert 0.3 < np.abs(samples).max() <= 1.0
    assert loudness(samples, 0.0, 0.4) < 0.2 * loudness(samples, 0.5, 7.0)
    again = music(np.random.RandomState(1), BEATS, 9.0, STYLES[style])
    np.testing.assert_array_equal(samples, again)


def test_clicks_are_on_beats_only() -> None:
    samples = clicks(np.random.RandomState(0), BEATS, 8.0)
    for beat in BEATS:
        assert loudness(samples, beat, beat + 0.02) > 20 * loudness(samples, beat - 0.1, beat)


def test_a_level_of_0_is_silence() -> None:
    levels = np.ones(len(BEATS))
    levels[6:] = 0.0
    samples = music(np.random.RandomState(2), BEATS, 9.0, STYLES["rock"], levels)
    assert loudness(samples, BEATS[8], BEATS[11]) < 0.1 * loudness(samples, BEATS[0], BEATS[5])


def test_a_wav_file_contains_the_samples() -> None:
    samples = np.array([0.0, 0.5, -1.0, 2.0])
    with wave.open(io.BytesIO(write_wav(samples, 8000))) as file:
        assert (file.getnchannels(), file.getsampwidth(), file.getframerate()) == (1, 2, 8000)
        kept = np.frombuffer(file.readframes(4), dtype="<i2")
    np.testing.assert_array_equal(kept, [0, 16384, -32767, 32767])
