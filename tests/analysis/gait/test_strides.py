"""Strides of walks whose strikes, lengths and times are known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.analysis.gait.strides import Stride, strides_of
from app.analysis.gait.summary import GaitRow, summarize, symmetry_index
from app.analysis.gait.walk import MIN_RATE, walk_of
from app.errors import NoGait
from app.motion.motion import Motion
from app.motion.roles.joint_roles import JointRole
from tests.analysis.gait.walks import planted_walk
from tests.bodies import motion_of, standing, waving


def strides(motion: Motion) -> tuple[Stride, ...]:
    return strides_of(walk_of(motion))


def row(motion: Motion, name: str) -> GaitRow:
    return next(one for one in summarize(strides(motion)) if one.parameter.name == name)


@pytest.mark.parametrize("rate", [30.0, 60.0, 120.0])
def test_a_known_walk_is_measured(rate: float) -> None:
    motion = planted_walk(rate=rate, stride_time=1.1, stride_length=1.3, stance=0.62, width=0.12)
    for name, expected, within in (
        ("cadence_steps_per_min", 120 / 1.1, 1.5),
        ("speed_m_per_s", 1.3 / 1.1, 0.02),
        ("stride_time_s", 1.1, 0.01),
        ("stride_length_m", 1.3, 0.01),
        ("step_time_s", 0.55, 0.01),
        ("step_length_m", 0.65, 0.01),
        ("step_width_m", 0.12, 0.005),
        ("stance_pct", 62, 3.0),
        ("swing_pct", 38, 3.0),
        ("double_support_pct", 24, 5.0),
    ):
        found = row(motion, name)
        assert found.left.mean == pytest.approx(expected, abs=within), name
        assert found.right.mean == pytest.approx(expected, abs=within), name
        assert found.left.count >= 3


def test_the_parts_of_a_stride_add_up() -> None:
    for stride in strides(planted_walk()):
        assert stride.strike < stride.off < stride.next_strike
        assert not stride.is_run
        assert stride.double_support_time < stride.stance_time
        assert stride.strike < stride.other_off < stride.other_strike < stride.off


def test_a_limp_shows_in_step_times_and_in_the_symmetry() -> None:
    even, limping = planted_walk(), planted_walk(limp=0.1)
    assert row(even, "step_time_s").symmetry == pytest.approx(0, abs=2)
    found = row(limping, "step_time_s")
    assert found.right.mean - found.left.mean == pytest.approx(0.2, abs=0.02)
    assert found.symmetry == pytest.approx(100 * 0.2 / 0.55, abs=4)
    assert row(limping, "stride_time_s").symmetry == pytest.approx(0, abs=2)


@settings(max_examples=15, deadline=None)
@given(heading=st.floats(-3.1, 3.1), east=st.floats(-50, 50))
def test_place_and_heading_do_not_matter(heading: float, east: float) -> None:
    here, there = planted_walk(strides=3), planted_walk(strides=3, heading=heading)
    there = replace(there, positions=there.positions + np.float32([east, 0, 0]))
    one, other = strides(here), strides(there)
    assert len(one) == len(other)
    for before, after in zip(one, other, strict=True):
        assert after.side == before.side
        assert after.strike == pytest.approx(before.strike, abs=1e-3)
        assert after.length == pytest.approx(before.length, abs=1e-3)
        assert after.step_width == pytest.approx(before.step_width, abs=1e-3)
        turn = (after.heading - before.heading - heading + np.pi) % (2 * np.pi) - np.pi
        assert turn == pytest.approx(0, abs=1e-3)


def test_a_walk_may_turn() -> None:
    found = strides(planted_walk(strides=8, radius=3.0))
    assert len(found) >= 10
    for stride in found:
        assert stride.time == pytest.approx(1.1, abs=0.03)
        assert stride.step_width == pytest.approx(0.12, abs=0.1)
    headings = np.unwrap([stride.heading for stride in found])
    assert headings[-1] - headings[0] > 1.5


def test_a_person_who_walks_backward_has_feet_on_the_right_sides() -> None:
    forward = planted_walk()
    backward = replace(forward, positions=np.ascontiguousarray(forward.positions[::-1]))
    assert row(backward, "step_width_m").both.mean == pytest.approx(0.12, abs=0.01)


@pytest.mark.parametrize("body", [standing(120), waving()])
def test_what_is_no_walk_is_refused(body: np.ndarray) -> None:
    with pytest.raises(NoGait, match="expected at least one stride"):
        strides(motion_of(body))


def test_one_step_is_too_few() -> None:
    with pytest.raises(NoGait, match="found 0 strikes of the left foot"):
        strides(planted_walk(strides=1))


def test_feet_and_a_frame_rate_are_needed() -> None:
    walk = planted_walk()
    roles = {r: j for r, j in walk.roles.items() if r is not JointRole.LEFT_FOOT}
    with pytest.raises(NoGait, match="left_foot") as refused:
        strides(replace(walk, roles=roles))
    assert refused.value.places[0].location == "roles.left_foot"
    with pytest.raises(NoGait, match="frame rate"):
        strides(replace(walk, frame_rate=MIN_RATE - 1))


def test_symmetry_is_a_percentage_of_the_mean() -> None:
    assert symmetry_index(1.0, 1.0) == 0
    assert symmetry_index(0.9, 1.1) == pytest.approx(20)
    assert symmetry_index(1.1, 0.9) == pytest.approx(-20)
    assert np.isnan(symmetry_index(float("nan"), 1.0))
    assert np.isnan(symmetry_index(0.0, 0.0))
