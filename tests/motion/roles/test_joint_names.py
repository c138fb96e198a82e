"""Names in all conventions give roles and sides."""

from __future__ import annotations

import pytest

from app.motion.roles.joint_names import roles_by_name, side_and_word
from app.motion.roles.joint_roles import JointRole
from tests.people import CONVENTIONS, ROLES

R = JointRole


@pytest.mark.parametrize("convention", sorted(CONVENTIONS))
def test_each_naming_convention_is_understood(convention: str) -> None:
    names = CONVENTIONS[convention]
    found = roles_by_name([names[role] for role in ROLES])
    wrong = {role.value: names[role] for role, joint in found.items() if ROLES[joint] != role}
    assert not wrong
    left_to_the_tree = {R.CHEST} | ({R.HIPS} if convention == "ASF" else set())
    assert set(ROLES) - set(found) <= left_to_the_tree


@pytest.mark.parametrize(
    ("name", "side", "word"),
    [
        ("LeftUpLeg", "left", "upleg"),
        ("lfemur", "left", "femur"),
        ("mixamorig:RightArm", "right", "arm"),
        ("UPPERARM_L", "left", "upperarm"),
        ("LKNE", "left", "kne"),
        ("upper leg.R", "right", "upperleg"),
        ("KneeRight", "right", "knee"),
        ("Bip01 L Calf", "left", "calf"),
        ("joint_Root", None, "root"),
        ("lowerarm", None, "lowerarm"),
        ("Leg", None, "leg"),
        ("", None, ""),
    ],
)
def test_side_and_word(name: str, side: str | None, word: str) -> None:
    assert side_and_word(name) == (side, word)


def test_a_shoulder_is_the_collar_bone_only_next_to_an_upper_arm() -> None:
    assert roles_by_name(["LeftShoulder", "LeftArm"])[R.LEFT_SHOULDER] == 1
    assert roles_by_name(["LeftCollar", "LeftShoulder"])[R.LEFT_SHOULDER] == 1


def test_no_joint_has_two_roles() -> None:
    found = roles_by_name(["Hips", "LeftFoot", "LeftLeg", "SpineShoulder", "LeftHip"])
    assert len(set(found.values())) == len(found)
