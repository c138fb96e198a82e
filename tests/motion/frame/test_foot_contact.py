from __future__ import annotations

import numpy as np
import pytest

from app.motion.frame.foot_contact import (
    carried_by_feet,
    is_low,
    planted,
    skating,
    stances,
    standing,
)

RATE = 30.0


def steps(slide: float = 0.0, seconds: float = 4.0) -> np.ndarray:
    """(n, 2, 3) feet that stand and swing alternately, half a second each.

    slide: the forward speed of a standing foot in m/s.
    """
    t = np.arange(round(seconds * RATE)) / RATE
    feet = np.zeros((len(t), 2, 3))
    for foot in range(2):
        phase = (t + 0.5 * foot) % 1.0
        swing = np.clip((phase - 0.5) / 0.5, 0, 1)
        feet[:, foot, 1] = 0.08 + 0.15 * np.sin(np.pi * swing) ** 2
        eased = swing - np.sin(2 * np.pi * swing) / (2 * np.pi)
        feet[:, foot, 2] = np.floor(t + 0.5 * foot) + eased + slide * t
    return feet


def test_standing_feet_do_not_skate_and_sliding_feet_do() -> None:
    still = np.zeros((30, 2, 3))
    assert skating(still, RATE) == 0.0
    sliding = np.array(still)
    sliding[:, :, 2] = 0.3 * np.arange(30)[:, None] / RATE
    assert skating(sliding, RATE) == pytest.approx(0.3)
    assert skating(still[:1], RATE) == 0.0
    assert skating(steps(0.4), RATE) > skating(steps(), RATE) + 0.2


def test_a_foot_in_the_air_does_not_stand() -> None:
    feet = steps()
    high = feet[:, :, 1] > 0.15
    assert not is_low(feet)[high].any()
    assert standing(feet, RATE)[high].max() < 0.05
    found = stances(feet, RATE)
    assert {stance.foot for stance in found} == {0, 1}
    assert all(6 <= stance.stop - stance.first <= 20 for stance in found)


def test_the_hips_are_moved_so_that_standing_feet_stay() -> None:
    feet = steps(0.2)
    hips = np.stack([0 * feet[:, 0, 0], np.full(len(feet), 0.9), feet[:, :, 2].mean(axis=1)], 1)
    moved = carried_by_feet(hips, feet, RATE)
    carried = feet + (moved - hips)[:, None]
    assert skating(carried, RATE) < 0.6 * skating(feet, RATE)
    np.testing.assert_array_equal(moved[:, 1], hips[:, 1])
    np.testing.assert_array_equal(carried_by_feet(hips[:1], feet[:1], RATE), hips[:1])


def test_standing_feet_are_fixed_without_a_jump() -> None:
    feet = steps(0.2)
    fixed_feet = planted(feet, RATE)
    for stance in stances(feet, RATE):
        inside = fixed_feet[stance.first : stance.stop, stance.foot][:, [0, 2]]
        np.testing.assert_allclose(inside, inside[:1].repeat(len(inside), 0), atol=1e-9)
    np.testing.assert_array_equal(fixed_feet[..., 1], feet[..., 1])
    step_lengths = np.linalg.norm(np.diff(fixed_feet - feet, axis=0), axis=-1)
    assert step_lengths.max() * RATE < 0.6  # m/s, added to the speed of the feet
    flying = np.array(feet)
    flying[..., 1] = np.arange(len(feet))[:, None]
    flying[..., 2] = 5 * np.arange(len(feet))[:, None] / RATE
    np.testing.assert_array_equal(planted(flying, RATE), flying)
