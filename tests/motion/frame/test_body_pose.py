"""Single poses in the body frame are the same as a motion of this pose alone."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from app.motion.frame.body_frame import body_track
from app.motion.frame.body_pose import body_poses
from app.motion.motion import Motion
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from tests.bodies import motion_of, standing, turned_about_y, walking, waving

R = JointRole


def _at(role: JointRole) -> int:
    return SUN_ROLES.index(role)


def _alone(positions: np.ndarray) -> np.ndarray:
    """The slow twin: (13, 3) the local positions of a motion with one pose (13, 3)."""
    return body_track(motion_of(np.stack([positions, positions]))).local[0]


def test_a_pose_equals_a_motion_of_this_pose_alone() -> None:
    body = np.concatenate([walking(2.0, turn=0.8), waving(2.0)]).astype(np.float32)
    body[::2] += [30.0, -2.0, 11.0]
    found = body_poses(body)
    assert found.shape == body.shape
    np.testing.assert_allclose(found, [_alone(pose) for pose in body], atol=2e-6)


def test_a_pose_does_not_depend_on_other_poses() -> None:
    body = walking(1.0)
    together = body_poses(body)
    assert all(
        (body_poses(pose[None])[0] == own).all() for pose, own in zip(body, together, strict=True)
    )


@given(
    turn=st.floats(-7, 7), x=st.floats(-50, 50), y=st.floats(-2, 2), z=st.floats(-50, 50),
    scale=st.floats(0.01, 100),
)  # fmt: skip
@settings(max_examples=40, deadline=None)
def test_position_heading_and_size_do_not_change_a_pose(
    turn: float, x: float, y: float, z: float, scale: float
) -> None:
    body = walking(1.0)
    moved = turned_about_y(body, turn) * scale + [x, y, z]
    np.testing.assert_allclose(body_poses(moved), body_poses(body), atol=1e-9)


def test_a_missing_joint_counts_with_its_usual_proportion() -> None:
    """This is as in a motion without the joint, where it has the position of its neighbor."""
    motion = motion_of(walking(1.0))
    lacking = (R.HEAD, R.LEFT_FOOT, R.RIGHT_FOOT)
    roles = {role: joint for role, joint in motion.roles.items() if role not in lacking}
    less = Motion(
        **{name: getattr(motion, name) for name in Motion.__slots__}
        | {"roles": roles, "missing_roles": lacking}
    )
    track = body_track(less)
    np.testing.assert_allclose(body_poses(less.role_positions()), track.local, atol=2e-3)


def test_the_knees_give_the_heading_if_the_shoulders_are_upright() -> None:
    body = standing()[:1].copy()
    for shoulder, height in ((R.LEFT_SHOULDER, 0.6), (R.RIGHT_SHOULDER, 0.2)):
        body[:, _at(shoulder)] = body[:, _at(R.HIPS)] + np.array([0.0, height, 0.0])
    turned = turned_about_y(body, 1.0)
    np.testing.assert_allclose(body_poses(turned), body_poses(body), atol=1e-9)
    assert body_poses(turned)[0, _at(R.LEFT_KNEE), 0] > 0


def test_the_more_level_pair_gives_the_heading_if_none_is_level() -> None:
    body = standing()[:1].copy()
    for left, right, lean in (
        (R.LEFT_SHOULDER, R.RIGHT_SHOULDER, 0.01),
        (R.LEFT_KNEE, R.RIGHT_KNEE, 0.03),
    ):
        body[:, _at(left)] = body[:, _at(right)] + [lean, 0.4, 0.0]
    np.testing.assert_allclose(body_poses(turned_about_y(body, 2.0)), body_poses(body), atol=1e-9)


def test_a_pose_without_size_or_sides_is_nan() -> None:
    body = standing()[:3].copy()
    body[0] = [1.0, 2.0, 3.0]
    for left, right in ((R.LEFT_SHOULDER, R.RIGHT_SHOULDER), (R.LEFT_KNEE, R.RIGHT_KNEE)):
        body[1, _at(left)] = body[1, _at(right)]
    found = body_poses(body)
    assert np.isnan(found[:2]).all()
    assert np.isfinite(found[2]).all()
    assert body_poses(body[:0]).shape == (0, 13, 3)
