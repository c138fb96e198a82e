"""Beats of recordings: clicks and music with steady and drifting tempi."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from app.analysis.rhythm.audio_beats import find_audio_beats, heard_beats
from app.analysis.rhythm.beats import BeatSource
from app.analysis.rhythm.onsets import find_onsets
from app.demo.dances.music import STYLES
from app.demo.dances.sounds import SAMPLE_RATE
from tests.recordings import WITHOUT_BEAT, f_score, piece, without_beat


@pytest.mark.parametrize("bpm", [60.0, 97.0, 140.0])
def test_the_clicks_of_a_metronome_are_found_within_50_ms(bpm: float) -> None:
    samples, beats = piece(11, "clicks", bpm, drift=0.04, seconds=20.0)
    found = find_audio_beats(find_onsets(samples, SAMPLE_RATE))
    assert f_score(found.times, beats, within=0.05) > 0.94
    assert found.tempo == pytest.approx(60 / np.median(np.diff(beats)), rel=0.02)
    assert found.source is BeatSource.AUDIO
    assert found.confidence == 1.0


@pytest.mark.parametrize("style", STYLES)
def test_the_beats_of_every_style_are_heard(style: str) -> None:
    samples, beats = piece(12, style, 100.0, drift=0.03, seconds=24.0)
    heard = heard_beats(find_onsets(samples, SAMPLE_RATE))
    assert max(f_score(one.beats.times, beats) for one in heard) > 0.9
    # In the demo's Latin music more begins between the beats than on them.
    assert max(f_score(one.beats.times, beats) for one in heard[:3]) > 0.9
    scores = [one.score for one in heard]
    assert scores == sorted(scores, reverse=True)


def test_no_two_of_the_heard_beats_are_the_same() -> None:
    samples, _ = piece(15, "rock", 100.0, seconds=16.0)
    times = [one.beats.times for one in heard_beats(find_onsets(samples, SAMPLE_RATE))]
    assert len(times) > 4
    for some, others in combinations(times, 2):
        assert f_score(some, others, within=0.02) < 0.95


def test_beats_of_a_given_tempo_differ_in_phase() -> None:
    samples, _ = piece(13, "disco", 120.0, seconds=12.0)
    one, other = heard_beats(find_onsets(samples, SAMPLE_RATE), tempo=120.0)
    assert (one.beats.tempo, other.beats.tempo) == (120.0, 120.0)
    distance = np.abs(one.beats.times[:, None] - other.beats.times).min(axis=1)
    assert np.median(distance) == pytest.approx(0.25, abs=0.03)


@pytest.mark.parametrize("kind", WITHOUT_BEAT)
@pytest.mark.parametrize("seed", [0, 1])
def test_recordings_without_a_beat_have_no_beats(kind: str, seed: int) -> None:
    found = find_audio_beats(find_onsets(without_beat(seed, kind), SAMPLE_RATE))
    assert len(found.times) == 0
    assert found.tempo is None
    assert found.source is BeatSource.NONE
    assert found.confidence < 0.5


def test_a_given_tempo_is_used() -> None:
    samples, beats = piece(13, "disco", 120.0, seconds=12.0)
    onsets = find_onsets(samples, SAMPLE_RATE)
    half = find_audio_beats(onsets, tempo=60.0)
    assert half.tempo == 60.0
    assert np.median(np.diff(half.times)) == pytest.approx(1.0, abs=0.02)
    assert np.abs(half.times[:, None] - beats).min(axis=1).max() < 0.07


@pytest.mark.parametrize("seconds", [0.0, 0.01, 0.5, 1.0, 3.0])
def test_short_recordings_have_no_beats(seconds: float) -> None:
    samples = np.random.default_rng(0).normal(size=int(seconds * SAMPLE_RATE))
    found = find_audio_beats(find_onsets(samples, SAMPLE_RATE))
    assert len(found.times) == 0


def test_beats_cover_only_the_part_with_sound() -> None:
    samples, beats = piece(14, "march", 100.0, seconds=12.0)
    silence = np.zeros(5 * SAMPLE_RATE)
    padded = np.concatenate([silence, samples, silence])
    found = find_audio_beats(find_onsets(padded, SAMPLE_RATE))
    assert found.times[0] == pytest.approx(beats[0] + 5.0, abs=0.07)
    assert found.times[-1] < beats[-1] + 5.0 + 0.7
