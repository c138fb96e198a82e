"""Onsets are at the beginnings of sounds, at every sample rate."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from app.analysis.rhythm.onsets import RATE, find_onsets
from app.demo.dances.sounds import SAMPLE_RATE
from app.errors import ExtraNeeded
from tests.recordings import piece, without_beat


@pytest.mark.parametrize("style", ["clicks", "march", "ballad"])
def test_strength_is_largest_at_beats(style: str) -> None:
    samples, beats = piece(3, style, 90.0, seconds=12.0)
    strength = find_onsets(samples, SAMPLE_RATE).strength
    frames = np.round(beats * RATE).astype(int)
    at_beats = np.max([strength[frames + shift] for shift in (-1, 0, 1)], axis=0)
    assert np.median(at_beats) > 4 * strength.mean()


def test_the_time_of_an_onset_is_exact_to_50_ms() -> None:
    samples, beats = piece(1, "clicks", 60.0, seconds=12.0)
    strength = find_onsets(samples, SAMPLE_RATE).strength
    for beat in beats:
        near = slice(round((beat - 0.2) * RATE), round((beat + 0.2) * RATE))
        found = (near.start + int(strength[near].argmax())) / RATE
        assert found == pytest.approx(beat, abs=0.05)


@pytest.mark.parametrize("rate", [8000, 22050, 96000])
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
    assert onsets.rise.any()


@pytest.mark.parametrize("count", [0, 1, 5, 400, SAMPLE_RATE])
@pytest.mark.parametrize("rate", [2000.0, 11_025.5, 44_100.0, 400_000.0])
def test_silence_and_noise_of_any_length_and_rate_are_finite(count: int, rate: float) -> None:
    silent = find_onsets(np.zeros(count), rate)
    noisy = find_onsets(np.random.default_rng(0).normal(size=count), rate)
    for onsets in (silent, noisy):
        assert onsets.duration == count / rate
        for curve in (onsets.strength, onsets.rise, onsets.bass):
            assert len(curve) == pytest.approx(count / rate * RATE, abs=1)
            assert np.isfinite(curve).all()
    assert not silent.strength.any()


def test_long_recordings_are_described_in_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    samples, _ = piece(5, "rock", 100.0, seconds=6.0)
    whole = find_onsets(samples, SAMPLE_RATE)
    monkeypatch.setattr("app.analysis.rhythm.onsets.FRAMES_AT_ONCE", 50)
    parts = find_onsets(samples, SAMPLE_RATE)
    np.testing.assert_allclose(parts.strength, whole.strength, atol=1e-4)
    np.testing.assert_allclose(parts.bass, whole.bass, rtol=1e-4)


def test_the_failure_without_librosa_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "librosa", None)
    with pytest.raises(ExtraNeeded, match="pip install librosa"):
        find_onsets(np.zeros(100), SAMPLE_RATE)


def test_a_quiet_recording_has_the_onsets_of_a_loud_one() -> None:
    samples, _ = piece(4, "disco", 120.0, seconds=5.0)
    loud, quiet = (find_onsets(gain * samples, SAMPLE_RATE).strength for gain in (1.0, 1e-3))
    np.testing.assert_allclose(quiet, loud, atol=1e-3)
