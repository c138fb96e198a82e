from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from app.analysis.descriptors.joint_angles import (
    ANGLES,
    joint_angles,
    with_gaps_filled,
)
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray
from tests.bodies import standing, turned_about_y, walking, waving

R = JointRole


def _at(role: JointRole) -> int:
    return SUN_ROLES.index(role)


def _degrees(body: FloatArray) -> dict[str, float]:
    return dict(zip(ANGLES, np.degrees(joint_angles(body, 30.0))[0].tolist(), strict=True))


def _limb(body: FloatArray, joints: tuple[JointRole, ...], turn: Rotation) -> FloatArray:
    """`body` with joints[1:] turned about joints[0]."""
    moved = body.copy()
    pivot = body[:, _at(joints[0])]
    for joint in joints[1:]:
        moved[:, _at(joint)] = pivot + turn.apply(body[:, _at(joint)] - pivot)
    return moved


LEG = (R.HIPS, R.LEFT_KNEE, R.LEFT_FOOT)
SHIN = (R.LEFT_KNEE, R.LEFT_FOOT)


def _hanging() -> FloatArray:
    """A body whose left leg hangs straight down from the hips, its knee bent by 40 degrees."""
    body = standing(8)
    hips = body[:, _at(R.HIPS)]
    body[:, _at(R.LEFT_KNEE)] = hips - np.array([0.0, 0.4, 0.0])
    body[:, _at(R.LEFT_FOOT)] = hips - np.array([0.0, 0.8, 0.0])
    return _limb(body, SHIN, Rotation.from_euler("x", 40, degrees=True))


def test_a_hanging_leg_has_no_swing_and_no_turn_but_its_bend() -> None:
    found = _degrees(_hanging())
    assert found["left_hip_bend"] == pytest.approx(40, abs=1e-3)
    for angle in ("flexion", "aside", "turn"):
        assert found[f"left_hip_{angle}"] == pytest.approx(0, abs=1e-3)


@pytest.mark.parametrize(
    ("axis", "angle", "degrees"),
    [("x", "flexion", 50.0), ("z", "aside", 30.0), ("y", "turn", 25.0), ("y", "turn", -60.0)],
)
def test_one_turn_is_one_angle(axis: str, angle: str, degrees: float) -> None:
    body = _limb(_hanging(), LEG, Rotation.from_euler(axis, degrees, degrees=True))
    found = _degrees(body)
    for name in ("flexion", "aside", "turn"):
        expected = degrees if name == angle else 0.0
        assert abs(found[f"left_hip_{name}"]) == pytest.approx(abs(expected), abs=1e-3)
    assert found["left_hip_bend"] == pytest.approx(40, abs=1e-3)


def test_both_sides_are_alike() -> None:
    body = walking(seconds=2.0, turn=0.3)
    mirrored = body[:, [SUN_ROLES.index(role.mirrored()) for role in SUN_ROLES]] * [-1, 1, 1]
    one = dict(zip(ANGLES, joint_angles(body, 30.0).T, strict=True))
    other = dict(zip(ANGLES, joint_angles(mirrored, 30.0).T, strict=True))
    for name in ("left_hip_flexion", "left_hip_bend", "left_arm_bend", "left_arm_flexion"):
        np.testing.assert_allclose(other[name.replace("left", "right")], one[name], atol=1e-6)
    for name in ("left_hip_aside", "left_hip_turn", "left_arm_turn", "left_arm_aside"):
        np.testing.assert_allclose(other[name.replace("left", "right")], -one[name], atol=1e-6)


@settings(max_examples=20, deadline=None)
@given(st.floats(-3, 3), st.floats(-5, 5), st.floats(0.3, 3), st.booleans())
def test_place_heading_and_size_do_not_matter(
    turn: float, shift: float, size: float, waves: bool
) -> None:
    body = waving(seconds=1.0) if waves else walking(seconds=1.0)
    moved = size * turned_about_y(body, turn) + shift
    np.testing.assert_allclose(joint_angles(moved, 30.0), joint_angles(body, 30.0), atol=1e-5)


def test_a_body_without_limbs_or_in_one_place_has_angles_of_zero() -> None:
    body = standing(5)
    for role in (R.LEFT_ELBOW, R.LEFT_HAND):
        body[:, _at(role)] = body[:, _at(R.LEFT_SHOULDER)]
    found = dict(zip(ANGLES, joint_angles(body, 30.0)[0].tolist(), strict=True))
    assert [found[f"left_arm_{a}"] for a in ("flexion", "aside", "turn", "bend")] == [0.0] * 4
    assert not joint_angles(np.zeros((3, 13, 3)), 30.0).any()


def test_short_gaps_are_spanned_by_a_spline_and_long_ones_by_a_line() -> None:
    t = np.arange(60) / 30
    values = np.sin(2 * t)
    seen = np.ones(60, dtype=bool)
    seen[20:25] = seen[:3] = False
    np.testing.assert_allclose(with_gaps_filled(values, seen, 7)[20:25], values[20:25], atol=2e-4)
    assert (with_gaps_filled(values, seen, 7)[:3] == values[3]).all()
    line = with_gaps_filled(values, seen, 4)[20:25]
    np.testing.assert_allclose(np.diff(line), np.diff(line)[0])
    assert not with_gaps_filled(values, np.zeros(60, dtype=bool), 7).any()
