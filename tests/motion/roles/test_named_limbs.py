"""Rigs of animation programs: each role goes to the joint at its place that its name allows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from app.motion.roles.joint_names import side_and_word
from app.motion.roles.joint_roles import JointRole
from app.motion.roles.roles import find_roles
from app.motion.skeleton.recording import Recording
from tests.motion.plausibility.creatures import Bones, biped, chain, moving, pair

R = JointRole
UP, DOWN = (0.0, 0.1, 0.0), (0.0, -0.21, 0.0)


def found(recording: Recording) -> dict[JointRole, str]:
    skeleton = recording.skeleton
    roles = find_roles(skeleton.names, skeleton.parents, recording.positions)
    return {role: skeleton.names[joint] for role, joint in roles.items()}


def check(bones: Bones, expected: Mapping[str, str]) -> None:
    """expected: the joint by role; {} stands for both sides."""
    roles = found(moving(bones))
    for role, joint in expected.items():
        for side, mark in (("left", "L"), ("right", "R")):
            assert roles.get(R(role.format(side))) == joint.format(mark)
    assert not wrong_sides(roles)


def wrong_sides(roles: Mapping[JointRole, str]) -> list[tuple[JointRole, str]]:
    return [
        (role, name)
        for role, name in roles.items()
        if (side := side_and_word(name)[0]) is not None and not role.startswith(side)
    ]


def rigify(first: int, arm: str = "upper_arm", prefix: str = "DEF-") -> Bones:
    """A deform skeleton whose limbs are split in two, with the numbers of copies."""

    def name(part: str, number: int) -> str:
        return f"{prefix}{part}.{{}}.{number:03d}"

    spine = " ".join(f"{prefix}spine.{number:03d}" for number in range(7, 13))
    middle = chain(
        f"root {spine}", None, (0, 0, 0), (0, 0.95, 0), UP, UP, (0, 0.15, 0), (0, 0.15, 0), UP
    )
    arms = (name("shoulder", first), name(arm, first), name(arm, first + 1))
    arms += (name("forearm", first), name("forearm", first + 1), name("hand", first))
    legs = (name("thigh", first), name("thigh", first + 1), name("shin", first))
    legs += (name("shin", first + 1), name("foot", first), name("toe", first))
    return {
        **middle,
        **pair(
            " ".join(arms), f"{prefix}spine.010",
            (0.04, 0.12, 0), (0.13, 0, 0), (0.14, 0, 0), (0.14, 0, 0), (0.12, 0, 0), (0.12, 0, 0),
        ),
        **pair(
            " ".join(legs), f"{prefix}spine.007",
            (0.09, -0.03, 0), DOWN, DOWN, DOWN, DOWN, (0, -0.06, 0.14),
        ),
    }  # fmt: skip


@pytest.mark.parametrize("first", [1, 2, 7])
@pytest.mark.parametrize("prefix", ["DEF-", ""])
def test_the_parts_of_a_split_limb_are_followed_from_its_start_to_its_end(
    first: int, prefix: str
) -> None:
    expected = {
        "{}_upper_leg": f"{prefix}thigh.{{}}.{first:03d}",
        "{}_knee": f"{prefix}shin.{{}}.{first:03d}",
        "{}_foot": f"{prefix}foot.{{}}.{first:03d}",
        "{}_toes": f"{prefix}toe.{{}}.{first:03d}",
        "{}_shoulder": f"{prefix}upper_arm.{{}}.{first:03d}",
        "{}_elbow": f"{prefix}forearm.{{}}.{first:03d}",
        "{}_hand": f"{prefix}hand.{{}}.{first:03d}",
        "neck": f"{prefix}spine.011",
        "head": f"{prefix}spine.012",
    }
    check(rigify(first, prefix=prefix), expected)


def test_twist_joints_have_no_role() -> None:
    extra = {
        **pair("{}_ThighTwist", "Hips", (0.1, -0.1, 0)),
        **pair("{}_ForearmRoll", "L_Forearm", (0.1, 0, 0)),
    }
    check(biped(extra=extra), {"{}_upper_leg": "{}_Thigh", "{}_elbow": "{}_Forearm"})


@pytest.mark.parametrize("helper", ["{}HipJoint", "__UpLeg_{}", "{}_Hip_01"])
def test_a_helper_joint_in_the_hips_is_no_upper_leg(helper: str) -> None:
    middle = chain(
        "Hips Spine Neck Head", None, (0, 0.95, 0), (0, 0.3, 0), (0, 0.2, 0), (0, 0.1, 0)
    )
    upper = "UpLeg_{}" if "UpLeg" in helper else "{}Hip"
    legs = pair(
        f"{helper} {upper} {{}}Knee {{}}Ankle", "Hips",
        (0, 0, 0), (0.1, -0.05, 0), (0, -0.42, 0), (0, -0.42, 0),
    )  # fmt: skip
    arms = pair("{}Shoulder {}Elbow {}Wrist", "Spine", (0.2, 0.2, 0), (0.3, 0, 0), (0.25, 0, 0))
    check({**middle, **legs, **arms}, {"{}_upper_leg": upper, "hips": "Hips"})


@pytest.mark.parametrize(
    ("arm", "leg", "middle"),
    [
        (
            "Scapula_{} Shoulder_{} Elbow_{} Wrist_{}",
            "Hip_{} Knee_{} Ankle_{} Toes_{}",
            "Root_M Spine1_M Chest_M Neck_M Head_M",
        ),
        (
            "shoulder.{} arm_stretch.{} forearm_stretch.{} hand.{}",
            "thigh_stretch.{} leg_stretch.{} foot.{} toes_01.{}",
            "root.x spine_01.x spine_03.x neck.x head.x",
        ),
        (
            "clavicle.{} upperarm01.{} lowerarm01.{} wrist.{}",
            "upperleg01.{} lowerleg01.{} foot.{} toe1-1.{}",
            "root spine05 spine01 neck01 head",
        ),
        (
            "{}_Clavicle_J {}_Shoulder_J {}_Elbow_J {}_Wrist_J",
            "{}_Hip_J {}_Knee_J {}_Ankle_J {}_Toe_J",
            "Pelvis_J Spine1_J Spine3_J Neck_J Head_J",
        ),
        (
            "clavicle01_{} upperArm01_{} foreArm01_{} hand01_{}",
            "thigh01_{} shin01_{} foot01_{} toe01_{}",
            "pelvis01 spine01 chest01 neck01 head01",
        ),
    ],
)
def test_rigs_with_endings_of_their_own_have_their_joints(arm: str, leg: str, middle: str) -> None:
    names = middle.split()
    bones = {
        **chain(middle, None, (0, 0.95, 0), (0, 0.12, 0), (0, 0.2, 0), (0, 0.15, 0), UP),
        **pair(arm, names[2], (0.04, 0.1, 0), (0.13, 0, 0), (0.28, 0, 0), (0.25, 0, 0)),
        **pair(leg, names[0], (0.09, -0.03, 0), (0, -0.42, 0), (0, -0.42, 0), (0, -0.06, 0.14)),
    }
    arms, legs = arm.split(), leg.split()
    expected = dict(zip(("{}_shoulder", "{}_elbow", "{}_hand"), arms[1:], strict=True))
    expected |= dict(zip(("{}_upper_leg", "{}_knee", "{}_foot"), legs[:3], strict=True))
    check(bones, expected | {"hips": names[0], "neck": names[3], "head": names[4]})


@pytest.mark.parametrize(
    ("arm", "leg"),
    [
        ("arm_01_{} arm_02_{} arm_03_{} arm_04_{}", "leg_01_{} leg_02_{} leg_03_{} leg_04_{}"),
        ("clavicle_{} arm_{}0_0 arm_{}0_1 arm_{}0_end", "leg_{}0_0 leg_{}0_1 leg_{}0_end foot_{}0"),
    ],
)
def test_joints_of_a_limb_that_only_have_numbers_are_found_by_the_shape(arm: str, leg: str) -> None:
    bones = {
        **chain("Root Spine Chest Neck Head", None, (0, 0.95, 0), UP, (0, 0.3, 0), UP, UP),
        **pair(arm, "Chest", (0.03, 0.05, 0), (0.15, 0, 0), (0.29, 0, 0), (0.25, 0, 0)),
        **pair(leg, "Root", (0.1, -0.05, 0), (0, -0.42, 0), (0, -0.42, -0.01), (0, -0.05, 0.14)),
    }
    parts = ("upper_leg", "knee", "foot"), ("shoulder", "elbow", "hand")
    joints = leg.split()[:3], arm.split()[1:]
    for names, limb in zip(joints, parts, strict=True):
        check(bones, {f"{{}}_{part}": name for part, name in zip(limb, names, strict=True)})


@pytest.mark.parametrize("seed", range(5))
def test_no_joint_has_a_role_of_the_other_side(seed: int) -> None:
    """The words of limbs are unknown, and the body is mirrored, so that the shape contradicts."""
    names = {"arm": "Zza{}. Zzb{}. Zzc{}.", "leg": "Yya{}. Yyb{}. Yyc{}. Yyd{}."}
    plain = moving(biped(names={part: text.replace("{}.", "_{}") for part, text in names.items()}))
    mirror = np.array([-1, 1, 1], dtype=np.float32)
    noise = np.random.default_rng(seed).normal(0, 0.01, plain.positions.shape)
    for positions in (plain.positions, plain.positions * mirror):
        recording = replace(plain, positions=(positions + noise).astype(np.float32))
        roles = found(recording)
        assert R.LEFT_KNEE in roles
        assert not wrong_sides(roles)


def test_one_of_two_copies_of_a_skeleton_is_used_as_a_whole() -> None:
    """A control skeleton comes first, but has no feet and hands."""
    control = pair("ORG-thigh.{} ORG-shin.{}", "Hips", (0.1, -0.05, 0), (0, -0.4, 0))
    deform = pair(
        "DEF-thigh.{} DEF-shin.{} DEF-foot.{}", "Hips",
        (0.1, -0.05, 0), (0, -0.42, 0), (0, -0.42, 0),
    )  # fmt: skip
    middle = chain(
        "Hips Spine Neck Head", None, (0, 0.95, 0), (0, 0.3, 0), (0, 0.2, 0), (0, 0.1, 0)
    )
    expected = {"{}_upper_leg": "DEF-thigh.{}", "{}_knee": "DEF-shin.{}", "{}_foot": "DEF-foot.{}"}
    check({**middle, **control, **deform}, expected)
