"""Keyposes: the stops of dances are found; nothing else is."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest

from app.analysis.energy import EnergyMethod
from app.analysis.keyposes import Keyposes, find_keyposes
from app.motion.body_frame import BodyTrack, body_track
from tests.bodies import motion_of, standing
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
    assert f_score([find_keyposes(track, beats=made.beats) for made, track in tracks]) > 0.92
    assert f_score([find_keyposes(track) for _, track in tracks]) > 0.9
    assert f_score([find_keyposes(track, beats=np.zeros(0)) for _, track in tracks]) > 0.88


def test_rms_finds_more_than_the_printed_equations() -> None:
    def score(method: EnergyMethod) -> float:
        tracks = dances()
        return f_score([find_keyposes(t, method=method, beats=d.beats) for d, t in tracks])

    assert score(EnergyMethod.RMS) > score(EnergyMethod.PRINTED) > 0.75


def test_frames_rise_and_times_agree() -> None:
    _, track = dances()[0]
    found = find_keyposes(track, method="printed")
    assert (np.diff(found.frames) > 0).all()
    np.testing.assert_allclose(found.times, found.frames / 30.0)
    assert len(found.global_energy) == len(found.local_energy) == track.frames
    assert found.method is EnergyMethod.PRINTED


def test_higher_demands_leave_fewer_keyposes() -> None:
    made, track = dances()[2]
    counts = [
        len(find_keyposes(track, beats=made.beats, t1=t1, t2=t2).frames)
        for t1, t2 in ((1.0, 0.0), (0.35, 0.7), (0.0, 3.0))
    ]
    assert counts[0] >= counts[1] >= counts[2]
    assert counts[2] < len(made.stops)


def test_local_energy_speaks_where_global_energy_is_silent() -> None:
    """Carried along at a steady speed, the stops are seen from the waist alone."""
    made, _ = dances()[1]
    carried = made.positions + (np.arange(len(made.positions)) / made.rate)[:, None, None] * [
        3,
        0,
        0,
    ]
    track = body_track(motion_of(carried, made.rate))
    found = find_keyposes(track, beats=made.beats)
    assert precision_and_recall(found.times, made.stops)[1] > 0.8


def test_stillness_and_two_frames_have_none() -> None:
    for body in (standing(2), standing(90)):
        assert len(find_keyposes(body_track(motion_of(body))).frames) == 0


def test_one_beat_and_beats_outside_the_clip_are_allowed() -> None:
    _, track = dances()[0]
    assert len(find_keyposes(track, beats=np.array([2.0])).frames) <= 1
    assert len(find_keyposes(track, beats=np.array([900.0, 901.0])).frames) == 0


def test_another_method_is_refused() -> None:
    with pytest.raises(ValueError, match="speed"):
        find_keyposes(dances()[0][1], method="speed")
