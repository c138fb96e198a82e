"""Candidates for keyposes: the beat and the frame of each minimum."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from app.analysis.keyposes.candidates import Scope, at_beats, at_energy_minima
from app.analysis.keyposes.energy_minima import EnergyMinimum

NONE = np.zeros(0)


def minimum(first: int, last: int, energy: float = 0.0, **ends: bool) -> EnergyMinimum:
    at = {"at_start": False, "at_end": False} | ends
    return EnergyMinimum((first + last) // 2, first, last, energy, 1.0, **at)


def frames(minima: list[EnergyMinimum], beats: list[float]) -> list[tuple[int, int | None]]:
    return [(c.frame, c.beat) for c in at_beats(tuple(minima), np.array(beats), Scope.GLOBAL)]


def test_a_candidate_is_at_the_frame_nearest_to_its_beat() -> None:
    minima = [minimum(18, 24), minimum(41, 45), minimum(70, 90)]
    assert frames(minima, [20.0, 40.0, 60.0, 80.0]) == [(20, 0), (41, 1), (80, 3)]


def test_a_minimum_far_from_every_beat_is_no_candidate() -> None:
    assert frames([minimum(29, 31)], [20.0, 40.0, 60.0]) == []


def test_of_two_minima_at_a_beat_the_lower_one_is_used_unless_it_is_far() -> None:
    assert frames([minimum(36, 37, 0.3), minimum(41, 42, 0.1)], [20.0, 40.0, 60.0]) == [(41, 1)]
    assert frames([minimum(34, 34, 0.1), minimum(40, 42, 0.2)], [20.0, 40.0, 60.0]) == [(40, 1)]


def test_a_freeze_over_several_beats_is_one_candidate_at_its_start() -> None:
    beats = [20.0, 40.0, 60.0, 80.0]
    assert frames([minimum(19, 62)], beats) == [(20, 0)]
    assert frames([minimum(0, 62, at_start=True)], beats) == [(60, 2)]


def test_one_beat_is_enough_and_no_beat_gives_no_candidate() -> None:
    assert frames([minimum(10, 12), minimum(22, 26)], [25.0]) == [(25, 0)]
    assert frames([minimum(10, 12)], []) == []


def test_a_gap_between_beats_is_searched_only_near_beats() -> None:
    assert frames([minimum(50, 52)], [0.0, 10.0, 20.0, 30.0, 90.0, 100.0]) == []


@given(
    st.lists(st.integers(0, 30), min_size=1, max_size=20),
    st.lists(st.floats(5.0, 40.0), min_size=2, max_size=12),
)
def test_beats_and_minima_are_paired_at_most_once_and_only_if_near(
    lengths: list[int], intervals: list[float]
) -> None:
    starts = np.cumsum([0, *(length + 5 for length in lengths[:-1])])
    minima = [minimum(int(s), int(s) + n) for s, n in zip(starts, lengths, strict=True)]
    beats = np.cumsum(intervals)
    found = at_beats(tuple(minima), beats, Scope.LOCAL)
    assert len({c.beat for c in found}) == len({c.minimum for c in found}) == len(found)
    for candidate in found:
        assert candidate.minimum.first <= candidate.frame <= candidate.minimum.last
        assert candidate.beat is not None
        away = abs(beats[candidate.beat] - candidate.frame)
        assert away <= 0.35 * 40 + 1


def test_without_beats_a_candidate_is_at_the_middle_and_that_of_a_freeze_at_its_start() -> None:
    minima = (minimum(20, 24), minimum(50, 54), minimum(80, 84), minimum(110, 160))
    assert [c.frame for c in at_energy_minima(minima, NONE, Scope.GLOBAL)] == [22, 52, 82, 112]


def test_the_first_pose_is_at_its_end_and_the_last_pose_at_its_start() -> None:
    minima = (
        minimum(0, 40, at_start=True),
        minimum(60, 64),
        minimum(90, 94),
        minimum(120, 200, at_end=True),
    )
    assert [c.frame for c in at_energy_minima(minima, NONE, Scope.GLOBAL)] == [38, 62, 92, 122]
    short, whole = minimum(0, 3, at_start=True), minimum(0, 99, at_start=True, at_end=True)
    assert (
        at_energy_minima((short,), NONE, Scope.GLOBAL)
        == at_energy_minima((whole,), NONE, Scope.GLOBAL)
        == ()
    )


def test_only_beats_that_agree_with_the_minima_move_candidates() -> None:
    minima = tuple(minimum(s, s + 8) for s in (20, 50, 80, 110))
    agreeing = np.array([26.0, 56.0, 86.0, 116.0])
    assert [c.frame for c in at_energy_minima(minima, agreeing, Scope.GLOBAL)] == [26, 56, 86, 116]
    others = np.array([26.0, 40.0, 70.0, 100.0])
    assert [c.frame for c in at_energy_minima(minima, others, Scope.GLOBAL)] == [24, 54, 84, 114]
