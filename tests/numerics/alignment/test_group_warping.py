from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.numerics.alignment import group_warping
from app.numerics.alignment.group_warping import (
    group_means,
    inverse,
    means_of_warped,
    read_at,
    rising,
    warped,
    warping_times,
)
from app.numerics.arrays import FloatArray, IntArray


def wandering(count: int, size: int = 32, seed: int = 0) -> FloatArray:
    rng = np.random.default_rng(seed)
    return np.cumsum(rng.normal(size=(count, size, 3)), axis=1)


def test_a_large_number_is_warped_in_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    one, other = wandering(7, seed=1), wandering(7, seed=2)
    times, motions = warping_times(one, other), warped(one, other)
    monkeypatch.setattr(group_warping, "MAX_TAKES_AT_ONCE", 3)
    np.testing.assert_array_equal(warping_times(one, other), times)
    np.testing.assert_array_equal(warped(one, other), motions)


def test_one_reference_for_all_motions_and_no_motions() -> None:
    motions, reference = wandering(4), wandering(1, seed=3)[0]
    each = [warped(motion[None], reference)[0] for motion in motions]
    np.testing.assert_allclose(warped(motions, reference), each, rtol=1e-12)
    assert warped(motions[:0], reference).shape == (0, 32, 3)


def test_a_motion_onto_itself_is_not_moved() -> None:
    motions = wandering(3)
    np.testing.assert_allclose(warping_times(motions, motions), np.tile(np.arange(32), (3, 1)))
    np.testing.assert_allclose(warped(motions, motions), motions)


def bump(at: float, size: int = 32) -> FloatArray:
    return np.exp(-0.5 * ((np.arange(size) - at) / 3.0) ** 2)[:, None]


@given(st.floats(-4.0, 4.0))
def test_a_gesture_that_is_late_is_found_where_it_is(late: float) -> None:
    times = warping_times(bump(15 + late)[None], bump(15)[None])
    assert times[0, 15] == pytest.approx(15 + late, abs=1.0)
    assert (np.diff(times[0]) > 0).all()
    moved = read_at(bump(15 + late)[None], times)[0]
    assert np.abs(moved - bump(15)).max() < 0.25  # half a moment where it is steepest: 0.1


def late_middle(by: float) -> FloatArray:
    """(24, 3) a curve that never comes back to a position, its middle early or late."""
    time = np.linspace(0, 1, 24)
    time = time + by * np.sin(np.pi * time)
    return np.stack([np.sin(5 * time), np.cos(3 * time), time], axis=-1)


def test_a_motion_with_another_timing_is_warped_onto_the_reference() -> None:
    reference, late = late_middle(0.0), late_middle(-0.15)
    before = np.abs(late - reference).mean()
    after = np.abs(warped(late[None], reference)[0] - reference).mean()
    assert after < 0.35 * before


def test_each_group_gets_a_mean_that_its_takes_share() -> None:
    rng = np.random.default_rng(1)
    group: IntArray = np.array([0, 1] * 6)
    takes = np.stack([late_middle(by) for by in rng.uniform(-0.15, 0.15, 12)])
    takes[group == 1] += 3.0
    plain = group_means(takes, group)
    means = means_of_warped(takes, group, plain, warped)
    moved = np.abs(warped(takes, means[group]) - means[group]).mean()
    assert moved < 0.5 * np.abs(takes - plain[group]).mean()
    np.testing.assert_allclose(means[1] - 3.0, means[0], atol=0.2)


@given(st.lists(st.floats(-40, 70), min_size=32, max_size=32))
def test_time_always_rises_within_the_motion_and_can_be_turned_back(times: list[float]) -> None:
    risen = rising(np.array([times]))
    assert (np.diff(risen) > 0).all()
    assert risen.min() >= 0
    assert risen.max() <= 31 + 1e-9
    back = inverse(risen)
    inside = (np.arange(32) >= risen[0, 0]) & (np.arange(32) <= risen[0, -1])
    again = np.interp(back[0], np.arange(32), risen[0])
    np.testing.assert_allclose(again[inside], np.arange(32)[inside], atol=1e-6)


def test_a_rising_time_stays_as_it_is() -> None:
    times = np.linspace(2.0, 29.0, 32)[None]
    np.testing.assert_allclose(rising(times), times, atol=1e-9)


def test_parabolas_are_read_exactly_between_moments_and_moments_at_themselves() -> None:
    moments = np.arange(32.0)
    motion = np.stack([moments**2, 3 - moments], axis=-1)[None]
    times = np.linspace(1.0, 30.0, 32)[None]
    read = read_at(motion, times)[0]
    np.testing.assert_allclose(read, np.stack([times[0] ** 2, 3 - times[0]], axis=-1), atol=1e-9)
    np.testing.assert_array_equal(read_at(motion, moments[None]), motion)
