"""Hips and neck in the middle of two joints, found or named by a client."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.errors import BadField
from app.motion.canonical.canonical import canonicalize
from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.recording import Recording
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray
from tests.people import ROLES, person

R = JointRole
COCO = {
    **{R(f"{side}_{part}"): f"{side}_{name}" for side in ("left", "right") for part, name in (
        ("shoulder", "shoulder"), ("elbow", "elbow"), ("hand", "wrist"),
        ("upper_leg", "hip"), ("knee", "knee"), ("foot", "ankle"),
    )},
    R.HEAD: "nose",
}  # fmt: skip
MEDIAPIPE = {role: name.upper() for role, name in COCO.items()}


def joints_only(names: dict[JointRole, str], ears: bool = False) -> Recording:
    """The person as positions without a tree, with these joints only."""
    plain = person(dict.fromkeys(ROLES, "unnamed") | names)
    keep = [index for index, role in enumerate(ROLES) if role in names]
    labels = [plain.skeleton.names[index] for index in keep]
    positions = plain.positions[:, keep]
    if ears:
        head = plain.positions[:, [ROLES.index(R.HEAD)]]
        away = np.array([0.07, 0.02, 0], dtype=np.float32)
        positions = np.concatenate([positions, head + away, head - away * [1, -1, 1]], axis=1)
        labels += ["left_ear", "right_ear"]
    skeleton = Skeleton(tuple(labels), np.full(len(labels), -1), positions[0].astype(np.float64))
    return replace(plain, skeleton=skeleton, positions=positions.astype(np.float32), rotations=None)


def middle(recording: Recording, *names: str) -> FloatArray:
    columns = [recording.skeleton.names.index(name) for name in names]
    return np.asarray(recording.positions[:, columns].mean(axis=1))


@pytest.mark.parametrize("names", [COCO, MEDIAPIPE], ids=["COCO", "MediaPipe"])
def test_hips_and_neck_are_between_both_hips_and_both_shoulders(
    names: dict[JointRole, str],
) -> None:
    recording = joints_only(names)
    motion = canonicalize(recording)
    assert motion.missing_roles == ()
    assert motion.names[motion.roles[R.HEAD]] == names[R.HEAD]
    for role, part in ((R.HIPS, "upper_leg"), (R.NECK, "shoulder")):
        between = [names[R(f"{side}_{part}")] for side in ("left", "right")]
        expected = middle(recording, *between)
        np.testing.assert_allclose(motion.positions[:, motion.roles[role]], expected, atol=1e-5)
    (made,) = (caution for caution in motion.cautions if caution.code == "joints_made")
    assert names[R.LEFT_SHOULDER] in made.detail


def test_the_head_is_between_the_ears_where_only_a_nose_has_its_name() -> None:
    recording = joints_only(COCO, ears=True)
    motion = canonicalize(recording)
    found = motion.positions[:, motion.roles[R.HEAD]]
    np.testing.assert_allclose(found, middle(recording, "left_ear", "right_ear"), atol=1e-5)


def test_a_client_may_name_two_joints_for_their_middle() -> None:
    strange = {role: f"p{index}" for index, role in enumerate(COCO)}
    recording = joints_only(strange)
    sent: dict[str, str | list[str]] = {role.value: name for role, name in strange.items()}
    sent["hips"] = [strange[R.LEFT_UPPER_LEG], strange[R.RIGHT_UPPER_LEG]]
    sent["neck"] = [strange[R.LEFT_SHOULDER], strange[R.RIGHT_SHOULDER]]
    motion = canonicalize(recording, roles=sent)
    assert motion.missing_roles == ()
    expected = middle(recording, *sent["hips"])
    np.testing.assert_allclose(motion.positions[:, motion.roles[R.HIPS]], expected, atol=1e-5)


@pytest.mark.parametrize("joints", [[], ["p1", "p2", "p3"], ["p1", "nowhere"]])
def test_other_numbers_of_joints_and_unknown_ones_are_refused(joints: list[str]) -> None:
    recording = joints_only({role: f"p{index}" for index, role in enumerate(COCO)})
    with pytest.raises(BadField) as refused:
        canonicalize(recording, roles={"hips": joints})
    assert refused.value.places[0].location == "roles.hips"


def test_a_made_joint_has_a_name_of_its_own() -> None:
    recording = joints_only(COCO)
    names = tuple("middle_hips" if name == "nose" else name for name in recording.skeleton.names)
    motion = canonicalize(replace(recording, skeleton=replace(recording.skeleton, names=names)))
    assert len(set(motion.names)) == len(motion.names)
