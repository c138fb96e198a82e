from __future__ import annotations

import numpy as np
import pytest

from app.analysis.descriptors.motion_sample import SAMPLE_LENGTH, motion_sample
from app.motion.frame.body_frame import body_track
from tests.bodies import motion_of, standing, walking, waving


def sample(positions: np.ndarray, rate: float = 30.0) -> np.ndarray:
    return motion_sample(body_track(motion_of(positions, rate)))


def test_its_shape_is_fixed_and_all_is_finite() -> None:
    for positions in (walking(), waving(), standing(2), standing()):
        found = sample(positions)
        assert found.shape == (SAMPLE_LENGTH,) == (1250,)
        assert found.dtype == np.float32
        assert np.isfinite(found).all()


def test_the_phase_at_which_a_walk_begins_does_not_matter() -> None:
    walk = walking(6.0)
    np.testing.assert_allclose(sample(walk[:150]), sample(walk[13:163]), atol=0.02)


def test_place_size_and_frame_rate_do_not_matter() -> None:
    there = sample(walking(6.0))
    np.testing.assert_allclose(sample(1.3 * walking(6.0) + [4.0, 0.5, -7.0]), there, atol=1e-3)
    np.testing.assert_allclose(sample(walking(6.0, rate=120.0), 120.0), there, atol=0.03)


def test_the_net_turn_and_the_speed_stand_at_the_end() -> None:
    found = sample(walking(4.0, turn=0.4, speed=1.2))
    length = body_track(motion_of(walking(4.0))).body_length
    assert np.sinh(found[-2]) == pytest.approx(1.6, abs=0.1)
    assert found[-1] == pytest.approx(1.2 / length, rel=0.1)
    assert abs(sample(waving())[-1]) < 0.05


def test_a_longer_walk_is_the_same_walk() -> None:
    np.testing.assert_allclose(sample(walking(4.0)), sample(walking(9.0)), atol=0.02)
