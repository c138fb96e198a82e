"""Beats of motions: steady and drifting tempi of dances, and none in other motions."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from app.analysis.energy.energy import energies
from app.analysis.rhythm.beats import BeatSource, beats_of_tempo, find_beats, given_beats
from app.demo import DemoClip
from app.demo.dances import dance as drifting_dance
from app.formats.read import read_recording
from app.motion.canonical.canonical import canonicalize
from app.motion.frame.body_frame import body_track
from tests.bodies import motion_of, standing
from tests.dances import dance, irregular


def energy_of(clip: DemoClip) -> np.ndarray:
    return energies(body_track(canonicalize(read_recording(clip.content)))).global_energy


@pytest.mark.parametrize("tempo", [60, 75, 90, 105, 120, 140, 160, 180])
def test_the_tempo_and_the_beats_of_a_dance_are_found(tempo: float) -> None:
    made = dance(7, tempo, beats=20)
    energy = energies(body_track(motion_of(made.positions, made.rate))).global_energy
    found = find_beats(energy, 30.0)
    assert found.tempo == pytest.approx(tempo, rel=0.02)
    assert found.source is BeatSource.MOTION
    off = np.abs(found.times[:, None] - made.beats).min(axis=1)
    assert np.median(off) < 0.08


@pytest.mark.parametrize(("seed", "bpm", "noise"), [(1, 80.0, 0.0), (2, 100.0, 5.0), (3, 120, 10)])
def test_a_tempo_that_drifts_is_followed(seed: int, bpm: float, noise: float) -> None:
    clip = drifting_dance(seed, bpm=bpm, noise_mm=noise, drift=0.05, seconds=20.0)
    found, beats = find_beats(energy_of(clip), 30.0), np.array(clip.beats)
    assert found.tempo == pytest.approx(60 / np.median(np.diff(beats)), rel=0.03)
    assert np.mean(np.abs(beats[:, None] - found.times).min(axis=1) < 0.1) > 0.85
    assert np.ptp(np.diff(found.times[1:-1])) / np.median(np.diff(found.times)) > 0.03


def test_beats_reach_from_the_first_frame_to_the_last() -> None:
    clip = drifting_dance(1, bpm=80.0, seconds=20.0)
    energy = energy_of(clip)
    times = find_beats(energy, 30.0).times
    beat = float(np.median(np.diff(times)))
    assert 0.0 <= times[0] < 1.05 * beat
    assert 0.0 <= (len(energy) - 1) / 30.0 - times[-1] < 1.05 * beat
    assert np.all(np.diff(times) > 0.8 * beat)


def test_beats_of_a_given_tempo_are_at_the_stops_of_the_motion() -> None:
    made = dance(7, 90, beats=20)
    energy = energies(body_track(motion_of(made.positions, made.rate))).global_energy
    found = beats_of_tempo(energy, 30.0, 90.0)
    assert found.source is BeatSource.TEMPO
    assert found.tempo == 90.0
    assert found.confidence > 0.7
    assert np.median(np.abs(made.beats[:, None] - found.times).min(axis=1)) < 0.08


def test_beats_of_a_given_tempo_begin_at_the_first_frame_of_a_still_motion() -> None:
    found = beats_of_tempo(np.zeros(91), 30.0, 120.0)
    np.testing.assert_allclose(found.times, np.arange(6) * 0.5)
    assert (found.tempo, found.confidence, found.source) == (120.0, 0.0, BeatSource.TEMPO)
    assert len(beats_of_tempo(np.zeros(1), 30.0, 120.0).times) <= 1


def test_given_beats_are_used() -> None:
    found = given_beats(np.array([0.5, 1.0, 1.6, 2.0]))
    assert found.tempo == pytest.approx(120.0)
    assert (found.confidence, found.source) == (1.0, BeatSource.GIVEN)
    assert given_beats(np.array([1.0])).tempo is None


def test_the_beats_of_a_walk_are_its_steps() -> None:
    times = np.arange(360) / 30.0
    falling_at_each_step = 1.2 + 0.15 * np.cos(2 * np.pi * 1.8 * times + 0.4)
    uneven = 0.02 * np.random.default_rng(0).normal(size=360)
    found = find_beats(falling_at_each_step + uneven, 30.0)
    assert found.tempo == pytest.approx(108.0, rel=0.03)


def test_random_stops_rarely_have_beats() -> None:
    accepted = 0
    for seed in range(8):
        energy = energies(body_track(motion_of(irregular(seed, 100.0), 60.0))).global_energy
        accepted += find_beats(energy, 30.0).tempo is not None
    assert accepted <= 1


def test_aimless_motion_rarely_has_beats() -> None:
    accepted, rng = 0, np.random.default_rng(77)
    for slowness in np.linspace(2.0, 8.0, 20):
        wandering = gaussian_filter1d(rng.normal(size=(600, 20)), slowness, axis=0)
        accepted += find_beats(np.sqrt(np.square(wandering).mean(axis=1)), 30.0).tempo is not None
    assert accepted <= 2


@pytest.mark.parametrize("frames", [0, 1, 2, 20, 300])
def test_short_and_still_motions_have_no_beats(frames: int) -> None:
    found = find_beats(np.zeros(frames), 30.0)
    assert found.tempo is None
    assert len(found.times) == 0
    assert found.confidence == 0.0
    assert found.source is BeatSource.NONE


def test_noise_has_no_tempo() -> None:
    body = standing(300) + np.random.default_rng(0).normal(size=(300, 13, 3)) * 0.003
    found = find_beats(energies(body_track(motion_of(body))).global_energy, 30.0)
    assert found.tempo is None
    assert 0.0 <= found.confidence < 0.45
