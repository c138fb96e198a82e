"""The body frame: its axes, and what does not change it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.errors import NotHuman, TooShort
from app.motion.frame.body_frame import (
    ANALYSIS_RATE,
    body_length,
    body_track,
    both_tracks,
    smooth_track,
)
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from tests.bodies import motion_of, standing, turned_about_y, walking, waving

LEFT_HAND, LEFT_SHOULDER, HEAD, HIPS = (
    SUN_ROLES.index(JointRole(role)) for role in ("left_hand", "left_shoulder", "head", "hips")
)


def test_left_is_x_up_is_y_and_forward_is_z() -> None:
    track = body_track(motion_of(walking()))
    np.testing.assert_allclose(track.local[:, HIPS], 0.0, atol=1e-12)
    assert (track.local[:, LEFT_SHOULDER, 0] > 0.1).all()
    assert (track.local[:, HEAD, 1] > 0.3).all()
    assert track.velocity()[:, 2].mean() == pytest.approx(1.2 / track.body_length, rel=0.01)
    np.testing.assert_allclose(track.heading, 0.0, atol=1e-6)


@given(
    turn=st.floats(-7, 7), x=st.floats(-20, 20), y=st.floats(-2, 2), z=st.floats(-20, 20),
    scale=st.floats(0.3, 3),
)  # fmt: skip
@settings(max_examples=40, deadline=None)
def test_position_heading_and_size_do_not_change_local_positions(
    turn: float, x: float, y: float, z: float, scale: float
) -> None:
    body = walking(turn=0.5)
    one = body_track(motion_of(body))
    other = body_track(motion_of(turned_about_y(body, turn) * scale + [x, y, z]))
    np.testing.assert_allclose(other.local, one.local, atol=1e-4)
    np.testing.assert_allclose(other.velocity(), one.velocity(), atol=2e-3)
    np.testing.assert_allclose(other.yaw_rate(), one.yaw_rate(), atol=2e-3)
    assert other.body_length == pytest.approx(scale * one.body_length, rel=1e-4)


@pytest.mark.parametrize("rate", [25.0, 48.0, 60.0, 100.0, 120.0])
def test_the_frame_rate_does_not_change_local_positions(rate: float) -> None:
    one = body_track(motion_of(walking(rate=30.0, turn=0.3)))
    other = body_track(motion_of(walking(rate=rate, turn=0.3), rate))
    assert other.frames == one.frames
    assert np.abs(other.local - one.local)[3:-3].max() < 0.01


def test_the_heading_is_continuous_over_several_turns() -> None:
    track = body_track(motion_of(walking(seconds=10.0, turn=2.0)))
    assert track.heading[-1] - track.heading[0] == pytest.approx(20.0, abs=0.01)
    np.testing.assert_allclose(track.yaw_rate(), 2.0, atol=1e-3)


def test_the_heading_is_interpolated_while_the_shoulders_are_upright() -> None:
    body = standing(60)
    left, right = (SUN_ROLES.index(JointRole(f"{side}_shoulder")) for side in ("left", "right"))
    body[20:40, left] = [0.001, 1.6, 0.0]
    body[20:40, right] = [0.0, 1.2, 0.001]
    np.testing.assert_allclose(body_track(motion_of(body)).heading, 0.0, atol=1e-9)


def test_the_knees_give_left_and_right_without_shoulders() -> None:
    motion = motion_of(turned_about_y(standing(), 1.0))
    roles = {role: i for role, i in motion.roles.items() if "shoulder" not in role}
    track = body_track(replace(motion, roles=roles))
    np.testing.assert_allclose(track.heading, 1.0, atol=1e-6)
    assert np.isfinite(track.local).all()


def test_a_body_without_width_faces_z() -> None:
    body = standing()
    body[..., 0] = 0.0
    assert (body_track(motion_of(body)).heading == 0).all()


def test_missing_head_and_feet_hardly_change_the_size() -> None:
    motion = motion_of(standing())
    for lacking in ("head", "foot"):
        roles = {role: i for role, i in motion.roles.items() if lacking not in role}
        lengths = body_length(replace(motion, roles=roles)), body_length(motion)
        assert lengths[0] == pytest.approx(lengths[1], rel=0.1)


@pytest.mark.parametrize(("frames", "rate"), [(1, 30.0), (2, 120.0), (4, 240.0)])
def test_a_motion_that_is_too_short_is_refused(frames: int, rate: float) -> None:
    with pytest.raises(TooShort, match=f"{frames} frames"):
        body_track(motion_of(standing(frames), rate))


def test_a_body_without_size_is_refused() -> None:
    with pytest.raises(NotHuman):
        body_track(motion_of(np.zeros((60, 13, 3))))


def test_a_part_has_the_body_frame_of_the_whole() -> None:
    track = body_track(motion_of(waving()))
    part = track.part(30, 60)
    assert part.frames == 30
    assert part.duration == pytest.approx(30 / ANALYSIS_RATE)
    assert part.body_length == track.body_length
    np.testing.assert_array_equal(part.local, track.local[30:60])


def test_both_tracks_are_the_two_that_are_made_alone() -> None:
    motion = motion_of(walking())
    raw, smooth = both_tracks(motion)
    for one, alone in ((raw, body_track(motion)), (smooth, smooth_track(motion))):
        np.testing.assert_array_equal(one.positions, alone.positions)
        np.testing.assert_array_equal(one.local, alone.local)
        np.testing.assert_array_equal(one.heading, alone.heading)
