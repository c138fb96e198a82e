"""Implausible poses are found with their frames; poses of real bodies are accepted."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.analysis.low_dimensional.plausibility import Fault, judge_poses
from app.motion.frame.body_frame import body_track
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray
from tests.bodies import motion_of, standing, walking, waving

R = JointRole
SIDES = ("left", "right")


def _poses(frames: int = 10) -> FloatArray:
    """(frames, 13, 3) a standing body in body lengths."""
    return body_track(motion_of(standing(frames))).local.copy()


def _column(role: str) -> int:
    return SUN_ROLES.index(JointRole(role))


def _put(poses: FloatArray, role: str, frames: slice, place: FloatArray) -> None:
    poses[frames, _column(role)] = place


def _bend(poses: FloatArray, side: str, limb: str, frames: slice, direction: FloatArray) -> None:
    """Send the lower half of a limb into a direction."""
    middle, end = {"leg": ("knee", "foot"), "arm": ("elbow", "hand")}[limb]
    length = np.linalg.norm(
        poses[0, _column(f"{side}_{end}")] - poses[0, _column(f"{side}_{middle}")]
    )
    unit = np.asarray(direction) / np.linalg.norm(direction)
    _put(poses, f"{side}_{end}", frames, poses[frames, _column(f"{side}_{middle}")] + length * unit)


@pytest.mark.parametrize("body", [walking(turn=0.4), waving(), standing()])
def test_what_people_do_is_let_pass(body: FloatArray) -> None:
    found = judge_poses(body_track(motion_of(body)).local)
    assert found.faults == ()
    assert found.count == 0


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize(
    ("limb", "direction", "fault"),
    [
        ("leg", (0, -1, 1), Fault.BENT_BACKWARD),
        ("leg", (-0.21, 1, -0.15), Fault.FOLDED),
        ("arm", (0, -1, -1), Fault.BENT_BACKWARD),
        ("arm", (-0.14, 1, 0.15), Fault.FOLDED),
    ],
)
def test_limbs_beyond_their_range_are_found_where_they_are(
    side: str, limb: str, direction: tuple[float, ...], fault: Fault
) -> None:
    poses = _poses()
    mirror = [1.0 if side == "left" else -1.0, 1.0, 1.0]
    _bend(poses, side, limb, slice(3, 6), np.array(direction) * mirror)
    found = judge_poses(poses)
    joint = R(f"{side}_{'knee' if limb == 'leg' else 'elbow'}")
    assert [(f.fault, f.joint, f.first, f.last) for f in found.faults] == [(fault, joint, 3, 5)]
    assert found.implausible.tolist() == [3 <= frame < 6 for frame in range(10)]
    assert 3 <= found.faults[0].worst <= 5
    assert found.faults[0].beyond > 0


@pytest.mark.parametrize("side", SIDES)
def test_limbs_within_their_range_are_let_pass(side: str) -> None:
    outward = 1.0 if side == "left" else -1.0
    for limb, direction in [
        ("leg", (0, -0.2, -1)),
        ("leg", (0.3 * outward, -1, -0.5)),
        ("arm", (0, 0.2, 1)),
        ("arm", (-outward, 0, 0.6)),  # across the belly
        ("arm", (outward, 0, 0)),  # turned outward
    ]:
        poses = _poses()
        _bend(poses, side, limb, slice(0, 10), np.array(direction))
        assert judge_poses(poses).faults == (), (limb, direction)


def test_a_raised_arm_may_bend_any_way() -> None:
    poses = _poses()
    shoulder = poses[0, _column("left_shoulder")]
    _put(poses, "left_elbow", slice(0, 10), shoulder + np.array([0.02, 0.3, 0.0]))
    _bend(poses, "left", "arm", slice(0, 10), np.array([0, 1.0, -1.0]))
    assert judge_poses(poses).faults == ()


@pytest.mark.parametrize("side", SIDES)
def test_a_hand_inside_the_trunk_is_found_and_one_on_it_is_not(side: str) -> None:
    poses = _poses()
    trunk = 0.5 * (poses[0, _column("hips")] + poses[0, _column("neck")])
    _put(poses, f"{side}_hand", slice(7, 8), trunk + np.array([0, 0, 0.03]))
    _put(poses, f"{side}_hand", slice(8, 9), trunk + np.array([0, 0, 0.12]))
    _put(poses, f"{side}_hand", slice(9, 10), poses[0, _column("neck")] - np.array([0, 0, 0.05]))
    found = [f for f in judge_poses(poses).faults if f.fault is Fault.IN_TRUNK]
    assert [(f.joint, f.first, f.last) for f in found] == [(R(f"{side}_hand"), 7, 7)]
    assert found[0].beyond == pytest.approx(0.04, abs=0.005)


def test_a_head_that_hangs_between_the_shoulders_is_found() -> None:
    poses = _poses()
    _put(poses, "head", slice(0, 2), poses[0, _column("neck")] + np.array([0, -0.05, 0.15]))
    found = judge_poses(poses).faults
    assert [(f.fault, f.joint, f.first, f.last) for f in found] == [
        (Fault.TURNED_AWAY, R.HEAD, 0, 1)
    ]


def test_faults_come_by_time() -> None:
    poses = _poses()
    _bend(poses, "right", "leg", slice(6, 8), np.array([0, -1.0, 1.0]))
    _bend(poses, "left", "leg", slice(1, 2), np.array([0, -1.0, 1.0]))
    _bend(poses, "left", "leg", slice(4, 7), np.array([0, -1.0, 1.0]))
    found = judge_poses(poses)
    assert [(f.joint, f.first, f.last) for f in found.faults] == [
        (R.LEFT_KNEE, 1, 1), (R.LEFT_KNEE, 4, 6), (R.RIGHT_KNEE, 6, 7),
    ]  # fmt: skip
    assert found.count == 5


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_it_does_not_matter_how_the_body_lies(seed: int) -> None:
    draw = np.random.default_rng(seed)
    poses = _poses(6)
    _bend(poses, "left", "leg", slice(0, 2), np.array([0.1, -1.0, 1.0]))
    _bend(poses, "right", "arm", slice(3, 5), np.array([0, -1.0, -1.0]))
    q, _ = np.linalg.qr(draw.normal(size=(3, 3)))
    turned = poses @ (q * np.sign(np.linalg.det(q)))
    one, other = judge_poses(poses), judge_poses(turned)
    assert [(f.fault, f.joint, f.first, f.last) for f in one.faults] == [
        (f.fault, f.joint, f.first, f.last) for f in other.faults
    ]
    assert np.allclose([f.beyond for f in one.faults], [f.beyond for f in other.faults], atol=1e-6)


def test_a_body_without_size_is_no_error() -> None:
    found = judge_poses(np.zeros((4, 13, 3))).faults
    assert {f.fault for f in found} == {Fault.IN_TRUNK}
    assert np.isfinite([f.beyond for f in found]).all()
