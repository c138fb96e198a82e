"""Beats: the tempo of dances, and none where there is none."""

from __future__ import annotations

import numpy as np
import pytest

from app.analysis.beats import find_beats
from app.analysis.energy import energies
from app.motion.body_frame import body_track
from tests.bodies import motion_of, standing
from tests.dances import dance, irregular


@pytest.mark.parametrize("tempo", [60, 75, 90, 105, 120, 140, 160, 180])
def test_the_tempo_and_the_beats_of_a_dance_are_found(tempo: float) -> None:
    made = dance(7, tempo, beats=20)
    energy = energies(body_track(motion_of(made.positions, made.rate))).global_energy
    found = find_beats(energy, 30.0)
    assert found.tempo == pytest.approx(tempo, rel=0.02)
    off = np.abs(found.times[:, None] - made.beats).min(axis=1)
    assert np.median(off) < 0.08


def test_stops_at_no_beat_are_rarely_taken_for_one() -> None:
    accepted = 0
    for seed in range(8):
        energy = energies(body_track(motion_of(irregular(seed, 100.0), 60.0))).global_energy
        accepted += find_beats(energy, 30.0).tempo is not None
    assert accepted <= 1


@pytest.mark.parametrize("frames", [0, 1, 2, 20, 300])
def test_little_and_stillness_have_no_beats(frames: int) -> None:
    found = find_beats(np.zeros(frames), 30.0)
    assert found.tempo is None
    assert len(found.times) == 0
    assert found.confidence == 0.0


def test_noise_has_no_tempo() -> None:
    body = standing(300) + np.random.default_rng(0).normal(size=(300, 13, 3)) * 0.003
    found = find_beats(energies(body_track(motion_of(body))).global_energy, 30.0)
    assert found.tempo is None
    assert 0.0 <= found.confidence < 0.9
