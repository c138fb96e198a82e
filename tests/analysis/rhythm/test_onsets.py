"""Onsets are at the beginnings of sounds, at every sample rate."""

from __future__ import annotations

import numpy as np
import pytest

from app.analysis.rhythm.onsets import RATE, find_onsets
from app.demo.dances.sounds import SAMPLE_RATE
from tests.recordings import piece, without_beat


@pytest.mark.parametrize("style", ["clicks", "march", "ballad"])
def test_strength_is_largest_at_beats(style: str) -> None:
    samples, beats = piece(3, style, 90.0, seconds=12.0)
    strength = find_onsets(samples, SAMPLE_RATE).strength
    frames = np.round(beats * RATE).astype(int)
    at_beats = np.max([strength[frames + shift] for shift in range(-3, 4)], axis=0)
    assert np.median(at_beats) > 4 * strength.mean()


def test_the_time_of_an_onset_is_exact_to_20_ms() -> None:
    samples, beats = piece(1, "clicks", 60.0, seconds=12.0)
    strength = find_onsets(samples, SAMPLE_RATE).strength
    for beat in beats:
        near = slice(round((beat - 0.2) * RATE), round((beat + 0.2) * RATE))
        assert near.start + int(strength[near].argmax()) == pytest.approx(beat * RATE, abs=2)


@pytest.mark.parametrize("rate", [8000, 44100, 96000])
def test_the_sample_rate_matters_little(rate: int) -> None:
    samples, _ = piece(2, "march", 100.0, seconds=6.0)
    times = np.arange(int(6.0 * rate)) / rate
    resampled = np.interp(times, np.arange(len(samples)) / SAMPLE_RATE, samples)
    one = find_onsets(samples, SAMPLE_RATE).strength
    other = find_onsets(resampled, float(rate)).strength
    count = min(len(one), len(other))
    assert np.corrcoef(one[:count], other[:count])[0, 1] > 0.8


@pytest.mark.parametrize("kind", ["hum", "chords"])
def test_held_tones_have_no_onsets(kind: str) -> None:
    onsets = find_onsets(without_beat(0, kind), SAMPLE_RATE)
    assert not onsets.strength.any()
    assert onsets.loudness.any()


@pytest.mark.parametrize("count", [0, 1, 5, 400, SAMPLE_RATE])
def test_silence_of_any_length_is_finite(count: int) -> None:
    onsets = find_onsets(np.zeros(count), SAMPLE_RATE)
    for curve in (onsets.strength, onsets.rise, onsets.bass, onsets.loudness):
        assert len(curve) == int(count * RATE / SAMPLE_RATE) + 1
        assert not curve.any()


def test_a_quiet_recording_has_the_onsets_of_a_loud_one() -> None:
    samples, _ = piece(4, "disco", 120.0, seconds=5.0)
    loud, quiet = (find_onsets(gain * samples, SAMPLE_RATE).strength for gain in (1.0, 1e-3))
    np.testing.assert_allclose(quiet, loud, atol=1e-6)
