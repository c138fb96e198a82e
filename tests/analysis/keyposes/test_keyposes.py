"""Keyposes are the stops of dances and nothing else."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest

from app.analysis.energy.energy import EnergyMethod, Weights
from app.analysis.keyposes.candidates import Scope
from app.analysis.keyposes.keyposes import Keyposes, find_candidates, find_keyposes
from app.analysis.rhythm.beats import Beats, BeatSource
from app.motion.frame.body_frame import BodyTrack, body_track
from tests.bodies import motion_of, standing, turned_about_y, walking
from tests.dances import Dance, dance, precision_and_recall

TEMPI = (60, 80, 100, 120, 140, 160)


@lru_cache(maxsize=1)
def dances() -> list[tuple[Dance, BodyTrack]]:
    made = [dance(seed, tempo, beats=20) for seed, tempo in enumerate(TEMPI)]
    return [(one, body_track(motion_of(one.positions, one.rate))) for one in made]


def f_score(found: list[Keyposes]) -> float:
    """Mean over the dances of the harmonic mean of precision and recall."""
    scores = []
    for keyposes, (made, _) in zip(found, dances(), strict=True):
        precision, recall = precision_and_recall(keyposes.times, made.stops)
        scores.append(2 * precision * recall / max(precision + recall, 1e-9))
    return float(np.mean(scores))


def test_stops_are_found_on_given_estimated_and_without_beats() -> None:
    tracks = dances()
    assert f_score([find_keyposes(track, beats=made.beats) for made, track in tracks]) > 0.97
    assert f_score([find_keyposes(track) for _, track in tracks]) > 0.95
    assert f_score([find_keyposes(track, beats=np.zeros(0)) for _, track in tracks]) > 0.94


def test_rms_finds_more_than_the_printed_equations() -> None:
    def score(method: EnergyMethod) -> float:
        tracks = dances()
        return f_score([find_keyposes(t, method=method, beats=d.beats) for d, t in tracks])

    assert score(EnergyMethod.RMS) > score(EnergyMethod.PRINTED) > 0.85


@pytest.mark.parametrize("weights", Weights)
def test_both_kinds_of_weights_find_the_stops(weights: Weights) -> None:
    found = [find_keyposes(t, weights=weights, beats=d.beats) for d, t in dances()]
    assert f_score(found) > 0.95


def test_frames_rise_and_times_agree() -> None:
    _, track = dances()[0]
    found = find_keyposes(track, method="printed")
    assert (np.diff(found.frames) > 0).all()
    np.testing.assert_allclose(found.times, found.frames / 30.0)
    assert len(found.global_energy) == len(found.local_energy) == track.frames
    assert found.method is EnergyMethod.PRINTED


def test_stricter_thresholds_give_fewer_keyposes() -> None:
    made, track = dances()[2]
    demands = ((1.0, 0.0), (0.25, 0.7), (0.01, 0.7), (1e-6, 3.0))
    for beats in (made.beats, np.zeros(0)):
        candidates = find_candidates(track, beats=beats)
        counts = [len(candidates.select(t1, t2)) for t1, t2 in demands]
        assert counts == sorted(counts, reverse=True)
        assert counts[-1] == 0


def test_small_or_deep_candidates_are_selected_and_global_ones_have_priority() -> None:
    """Section 3.1, over every candidate of a dance."""
    made, track = dances()[0]
    candidates = find_candidates(track, beats=made.beats)
    for t1, t2 in ((0.25, 0.7), (0.02, 0.9), (0.005, 5.0)):
        expected = {}
        for beat in range(len(made.beats)):
            for scope in (Scope.GLOBAL, Scope.LOCAL):
                here = [c for c in candidates.found if (c.beat, c.scope) == (beat, scope)]
                if any(c.minimum.energy < t1 or c.minimum.drop > t2 for c in here):
                    expected[beat] = scope
                    break
        assert {c.beat: c.scope for c in candidates.select(t1, t2)} == expected


def test_local_energy_finds_stops_that_global_energy_does_not_show() -> None:
    """Carried along at a steady speed, the stops are seen from the waist alone."""
    made, _ = dances()[1]
    carried = made.positions + (np.arange(len(made.positions)) / made.rate)[:, None, None] * [
        3,
        0,
        0,
    ]
    track = body_track(motion_of(carried, made.rate))
    found = find_keyposes(track, beats=made.beats)
    assert precision_and_recall(found.times, made.stops)[1] > 0.9
    assert set(found.chosen_by) == {Scope.LOCAL}


def test_a_walker_has_a_keypose_at_each_step() -> None:
    track = body_track(motion_of(walking(8.0, steps_hz=0.9)))
    found = find_keyposes(track)
    assert len(found.frames) == pytest.approx(2 * 0.9 * 8.0, abs=2)
    assert np.diff(found.times) == pytest.approx(1 / (2 * 0.9), abs=0.1)
    strict = find_keyposes(track, t1=1e-6, t2=99.0)
    assert len(strict.frames) == 0


def test_stillness_and_two_frames_have_none() -> None:
    for body in (standing(2), standing(90)):
        assert len(find_keyposes(body_track(motion_of(body))).frames) == 0


def test_marker_noise_alone_is_no_dance() -> None:
    shaking = standing(300) + 0.005 * np.random.default_rng(0).normal(size=(300, 13, 3))
    assert len(find_keyposes(body_track(motion_of(shaking))).frames) == 0


@pytest.mark.parametrize("turn", [0.0, 2.0])
def test_place_heading_size_and_frame_rate_change_nothing(turn: float) -> None:
    made = dance(11, 100, beats=20, noise=0.0, rate=120.0)
    one = find_keyposes(body_track(motion_of(made.positions, 120.0)), beats=made.beats)
    moved = turned_about_y(made.positions[::2], turn) * 1.6 + [3.0, 0.1, -2.0]
    other = find_keyposes(body_track(motion_of(moved, 60.0)), beats=made.beats)
    np.testing.assert_array_equal(one.frames, other.frames)
    assert one.chosen_by == other.chosen_by


def test_the_order_of_beats_and_repetitions_do_not_matter() -> None:
    made, track = dances()[1]
    jumbled = np.concatenate([made.beats[::-1], made.beats])
    one, other = (find_keyposes(track, beats=beats) for beats in (made.beats, jumbled))
    np.testing.assert_array_equal(one.frames, other.frames)


def test_only_independent_beats_restrict_keyposes() -> None:
    made, track = dances()[2]
    every_other = made.beats[::2]
    law = find_keyposes(track, beats=Beats(every_other, None, 1.0, BeatSource.AUDIO))
    hint = find_keyposes(track, beats=Beats(every_other, None, 1.0, BeatSource.MOTION))
    away = [np.abs(every_other - time).min() for time in law.times]
    assert max(away) < 0.35 * 60 / made.tempo
    assert precision_and_recall(hint.times, made.stops)[1] > 0.9
    assert len(law.times) < 0.7 * len(hint.times)


def test_one_beat_and_beats_outside_the_clip_are_allowed() -> None:
    _, track = dances()[0]
    assert len(find_keyposes(track, beats=np.array([2.0])).frames) <= 1
    assert len(find_keyposes(track, beats=np.array([900.0, 901.0])).frames) == 0


def test_another_method_is_refused() -> None:
    with pytest.raises(ValueError, match="speed"):
        find_keyposes(dances()[0][1], method="speed")
