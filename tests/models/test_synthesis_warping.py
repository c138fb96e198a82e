from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.models import synthesis_warping
from app.models.synthesis_warping import (
    BAND,
    RELUCTANCE,
    held_moments,
    inverse,
    read_at,
    rising,
    warping_times,
)
from app.numerics.arrays import FloatArray


def naive_held(cost: FloatArray) -> FloatArray:
    """(m,) by the textbook's table, one cell after another."""
    size = len(cost)
    reach = max(1, int(BAND * size))
    reluctance = RELUCTANCE * float(cost.mean())
    total, came = np.full((size, size), np.inf), {}
    for i in range(size):
        for j in range(size):
            if abs(i - j) > reach:
                continue
            if i == j == 0:
                total[i, j] = cost[i, j]
                continue
            ways = []
            if i and j:
                ways.append((total[i - 1, j - 1], (i - 1, j - 1)))
            if i:
                ways.append((total[i - 1, j] + reluctance, (i - 1, j)))
            if j:
                ways.append((total[i, j - 1] + reluctance, (i, j - 1)))
            best = min(ways, key=lambda way: way[0])
            total[i, j], came[i, j] = best[0] + cost[i, j], best[1]
    held: list[list[int]] = [[] for _ in range(size)]
    here = (size - 1, size - 1)
    while True:
        held[here[1]].append(here[0])
        if here == (0, 0):
            return np.array([np.mean(moments) for moments in held])
        here = came[here]


def wandering(count: int, size: int = 32, seed: int = 0) -> FloatArray:
    rng = np.random.default_rng(seed)
    return np.cumsum(rng.normal(size=(count, size, 3)), axis=1)


@pytest.mark.parametrize("size", [2, 3, 9, 32])
def test_all_at_once_are_warped_as_one_after_another(size: int) -> None:
    one, other = wandering(20, size, 1), wandering(20, size, 2)
    cost = np.linalg.norm(one[:, :, None] - other[:, None], axis=-1)
    np.testing.assert_allclose(held_moments(cost), [naive_held(each) for each in cost])


def test_a_large_number_is_warped_in_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    one, other = wandering(7, seed=1), wandering(7, seed=2)
    whole = warping_times(one, other)
    monkeypatch.setattr(synthesis_warping, "AT_ONCE", 3)
    np.testing.assert_array_equal(warping_times(one, other), whole)


def test_a_motion_onto_itself_is_not_moved() -> None:
    motions = wandering(3)
    np.testing.assert_allclose(warping_times(motions, motions), np.tile(np.arange(32), (3, 1)))


def bump(at: float, size: int = 32) -> FloatArray:
    return np.exp(-0.5 * ((np.arange(size) - at) / 3.0) ** 2)[:, None]


@given(st.floats(-4.0, 4.0))
def test_a_gesture_that_is_late_is_found_where_it_is(late: float) -> None:
    times = warping_times(bump(15 + late)[None], bump(15)[None])
    assert times[0, 15] == pytest.approx(15 + late, abs=1.0)
    assert (np.diff(times[0]) > 0).all()
    moved = read_at(bump(15 + late)[None], times)[0]
    assert np.abs(moved - bump(15)).max() < 0.25  # half a moment where it is steepest: 0.1


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
