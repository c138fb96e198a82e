from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.analysis.descriptors.movement_signs import (
    CYCLE,
    MIN_OVERLAP,
    SIGNS,
    _cycle,
    movement_signs,
)
from app.motion.frame.body_frame import body_track
from app.numerics.arrays import FloatArray
from tests.bodies import motion_of, standing, turned_about_y, walking, waving


def signs(positions: FloatArray, rate: float = 30.0) -> dict[str, float]:
    found = movement_signs(body_track(motion_of(positions, rate)))
    return dict(zip(SIGNS, found.tolist(), strict=True))


def test_all_are_finite() -> None:
    for positions in (walking(), waving(), standing(2), standing()):
        assert all(np.isfinite(list(signs(positions).values())))


@given(
    angle=st.floats(-3.0, 3.0), size=st.floats(0.5, 2.0), x=st.floats(-5.0, 5.0),
)  # fmt: skip
def test_place_heading_and_size_do_not_matter(angle: float, size: float, x: float) -> None:
    walk = walking(turn=0.3)
    moved = turned_about_y(walk, angle) * size + [x, 0.0, -x]
    np.testing.assert_allclose(
        list(signs(moved).values()), list(signs(walk).values()), rtol=1e-3, atol=1e-3
    )


def test_they_measure_what_their_names_say() -> None:
    walk, wave, turn = signs(walking(6.0)), signs(waving()), signs(walking(turn=0.4))
    assert turn["turn_to_left"] == pytest.approx(0.4 * 4.0, rel=0.05)
    assert signs(walking(turn=-0.4))["turn_to_left"] == pytest.approx(-turn["turn_to_left"])
    assert abs(walk["turn"]) < 0.05
    assert walk["speed"] > wave["speed"]
    assert walk["cycle"] > 0.95
    cycles = (np.exp(walk["cycle_time"]) - 0.3) * 0.9
    assert cycles == pytest.approx(round(cycles), abs=0.05)
    assert wave["hand_height"] > walk["hand_height"]
    assert wave["right_hand_speed"] > wave["left_hand_speed"]
    leap = walking()
    leap[50:70, :, 1] += 0.4
    assert signs(leap)["rise"] > walk["rise"] + 1.0
    assert signs(leap)["flight"] > walk["flight"] + 0.5


def test_a_cycle_is_that_of_the_slow_obvious_way() -> None:
    rng = np.random.default_rng(0)
    for count in (5, 12, 40, 150):
        poses = rng.normal(size=(count, 3)).cumsum(axis=0)
        poses -= poses.mean(axis=0)
        best, lag = 0.0, 0
        for shift in range(
            int(CYCLE[0] * 30), min(int(CYCLE[1] * 30), count - count // MIN_OVERLAP)
        ):
            one, other = poses[:-shift].ravel(), poses[shift:].ravel()
            likeness = one @ other / np.sqrt((one @ one) * (other @ other))
            if likeness > best:
                best, lag = likeness, shift
        found = np.ravel(_cycle(poses.T[:, None], 30.0))
        np.testing.assert_allclose(found, (best, lag / 30.0), atol=1e-9)
