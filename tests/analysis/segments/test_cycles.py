"""Cycles: repeated sequences are found, and others are not."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.analysis.keyposes.keyposes import find_keyposes
from app.analysis.segments.cycles import Cycle, find_cycles
from app.motion.frame.body_frame import BodyTrack, body_track
from app.numerics.arrays import FloatArray
from tests.bodies import motion_of
from tests.cyclic_dances import CyclicDance, cyclic_dance


def _track(dance: CyclicDance) -> BodyTrack:
    return body_track(motion_of(dance.positions, dance.rate))


def _poses(track: BodyTrack) -> FloatArray:
    return track.local.reshape(track.frames, -1)


def _longest(cycles: tuple[Cycle, ...]) -> list[Cycle]:
    runs = [[c for c in cycles if c.run == run] for run in {c.run for c in cycles}]
    return max(runs, key=len, default=[])


@pytest.mark.parametrize("seed", range(200, 206))
@pytest.mark.parametrize(("poses", "times"), [(3, 5), (6, 3), (9, 2)])
def test_repeated_sequences_are_found_with_their_known_keyposes(
    seed: int, poses: int, times: int
) -> None:
    dance = cyclic_dance(seed, poses=poses, times=times)
    found = find_cycles(_poses(_track(dance)), np.array(dance.stops) * 30)
    run = _longest(found)
    assert [cycle.stop - cycle.first for cycle in run] == [poses] * len(run)
    # The last transition leads elsewhere, so a run may be a cycle short; the steps into the
    # first pose and out of the last are the dancer's own.
    assert times - 1 <= len(run) <= times
    assert abs(run[0].first - 3) <= poses
    assert run[-1].stop <= 3 + poses * times


@pytest.mark.parametrize("seed", range(210, 218))
def test_missed_keyposes_do_little_harm(seed: int) -> None:
    dance = cyclic_dance(seed, poses=6, times=5)
    track = _track(dance)
    found = find_keyposes(track).frames
    missed = np.delete(found, [len(found) // 3])
    period = np.median([end - start for start, end in dance.cycles])
    for keyposes in (found, missed):
        run = _longest(find_cycles(_poses(track), keyposes.astype(float)))
        lasts = [(keyposes[c.stop] - keyposes[c.first]) / 30 for c in run]
        assert len(run) >= 3
        assert np.median(lasts) == pytest.approx(period, rel=0.1)


@pytest.mark.parametrize("seed", range(220, 232))
def test_a_sequence_without_repetition_has_no_cycle(seed: int) -> None:
    dance = cyclic_dance(seed, poses=20, times=1)
    assert find_cycles(_poses(_track(dance)), np.array(dance.stops) * 30) == ()


def test_two_sequences_are_two_runs() -> None:
    one, other = (
        _track(cyclic_dance(seed, poses=4, times=4, before=0, after=0)) for seed in (240, 241)
    )
    poses = np.concatenate([_poses(one), _poses(other)])
    stops = np.array(cyclic_dance(240, poses=4, times=4, before=0, after=0).stops) * 30
    later = np.array(cyclic_dance(241, poses=4, times=4, before=0, after=0).stops) * 30
    found = find_cycles(poses, np.concatenate([stops, one.frames + later]))
    assert {cycle.run for cycle in found} == {0, 1}
    assert all(c.stop <= 16 for c in found if c.run == 0)
    assert all(c.first >= 15 for c in found if c.run == 1)
    assert [c.first for c in found] == sorted(c.first for c in found)


def test_a_body_that_stands_still_or_shakes_has_no_cycles() -> None:
    draw = np.random.default_rng(1)
    still, shaking = np.zeros((300, 39)), 0.002 * draw.normal(size=(300, 39))
    bounds = np.arange(0.0, 300.0, 15.0)
    assert find_cycles(still, bounds) == ()
    assert find_cycles(shaking, bounds) == ()


@pytest.mark.parametrize("bounds", [[], [3.0], [3.0, 9.0]])
def test_fewer_than_two_segments_have_no_cycles(bounds: list[float]) -> None:
    assert find_cycles(np.zeros((20, 39)), np.array(bounds)) == ()
    assert find_cycles(np.zeros((1, 39)), np.array([0.0, 0.5, 1.0])) == ()


def test_size_and_tempo_do_not_matter() -> None:
    dance = cyclic_dance(250, poses=5, times=4)
    poses, bounds = _poses(_track(dance)), np.array(dance.stops) * 30
    once = find_cycles(poses, bounds)
    assert len(once) >= 3
    assert find_cycles(3.0 * poses, bounds) == once
    assert find_cycles(poses[::2], bounds / 2) == once


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(2, 60), st.integers(0, 25))
def test_cycles_are_within_bounds_and_share_no_segment(
    seed: int, frames: int, keyposes: int
) -> None:
    draw = np.random.default_rng(seed)
    period = draw.integers(1, 6)
    poses = np.tile(draw.normal(size=(period, 4)), (frames // period + 1, 1))[:frames]
    bounds = np.sort(draw.choice(np.arange(2 * frames), min(keyposes, frames), replace=False) / 2.0)
    found = find_cycles(poses, bounds)
    covered = [segment for cycle in found for segment in range(cycle.first, cycle.stop)]
    assert len(covered) == len(set(covered))
    assert all(0 <= segment < len(bounds) - 1 for segment in covered)
    for run in {cycle.run for cycle in found}:
        own = [cycle for cycle in found if cycle.run == run]
        assert len(own) >= 2
        assert all(a.stop == b.first for a, b in pairwise(own))


def test_an_hour_of_steps_is_processed() -> None:
    t = np.arange(6000)
    poses = np.sin(2 * np.pi * t[:, None] / 20 + np.arange(6))
    found = find_cycles(poses, np.arange(0.0, 5990.0, 10.0))
    assert {cycle.stop - cycle.first for cycle in found} == {2}
    assert len(found) >= 298
