"""Hips, neck and head of bodies whose joints in the middle have unusual names."""

from __future__ import annotations

import pytest

from app.motion.roles.joint_roles import JointRole
from tests.motion.plausibility.creatures import Bones, chain, moving, pair
from tests.motion.roles.test_named_limbs import found

R = JointRole


def body(middle: str, top: int, *, leg: float = 0.84, extra: Bones | None = None) -> Bones:
    """A person. middle: the joints from the hips up; top: the index of the joint of the arms."""
    names = middle.split()
    up = [(0.0, 0.5 / top, 0.0)] * top + [(0.0, 0.13, 0.01)] * (len(names) - top - 1)
    return {
        **chain(middle, None, (0, leg + 0.1, 0), *up),
        **(extra or {}),
        **pair("upperarm.{} forearm.{} hand.{}", names[top], (0.17, 0.05, 0), (0.28, 0, 0),
               (0.25, 0, 0)),
        **pair("thigh.{} shin.{} foot.{}", names[0], (0.09, -0.03, 0), (0, -leg / 2, 0),
               (0, -leg / 2, 0)),
    }  # fmt: skip


@pytest.mark.parametrize(
    ("middle", "top", "neck", "head"),
    [
        ("hips spine chest head", 2, "chest", "head"),
        ("Hips Spine Head", 1, "Spine", "Head"),
        ("rig:hips rig:spine rig:chest rig:head", 2, "rig:chest", "rig:head"),
        ("spine spine.001 spine.002 spine.004 spine.006", 2, "spine.004", "spine.006"),
        ("Root Back1 Back2 Back3 Back4", 2, "Back3", "Back4"),
        ("Hips Spine Chest Throat Head", 2, "Throat", "Head"),
    ],
)
@pytest.mark.parametrize("leg", [0.84, 0.44])
def test_the_neck_is_where_the_arms_part_and_the_head_hangs(
    middle: str, top: int, neck: str, head: str, leg: float
) -> None:
    roles = found(moving(body(middle, top, leg=leg)))
    assert (roles[R.NECK], roles[R.HEAD]) == (neck, head)
    assert roles[R.HIPS] == middle.split()[0]


def test_joints_beside_the_spine_are_no_head() -> None:
    """Metarigs have `breast.L`, longer than the neck, and `pelvis.L` in the hips."""
    extra = {
        **pair("breast.{} breast_end.{}", "spine.003", (0.06, 0.1, 0.1), (0, 0, 0.5)),
        **pair("pelvis.{}", "spine", (0.06, 0.04, 0)),
    }
    roles = found(moving(body("spine spine.003 spine.004 spine.006", 1, extra=extra)))
    assert (roles[R.NECK], roles[R.HEAD]) == ("spine.004", "spine.006")


def test_a_body_whose_arms_leave_the_hips_has_no_neck_there() -> None:
    roles = found(moving(body("hips a b c", 0 + 1)))
    assert roles[R.NECK] != roles[R.HIPS]
