"""Finds joint roles by the names of joints, in the common naming conventions.

These are CMU/MotionBuilder `LeftUpLeg`, ASF `lfemur`, DAZ/Poser `lShldr`, Mixamo
`mixamorig:LeftArm`, Bandai Namco `UpperArm_L`, LAFAN1, SMPL `L_Hip`, Vicon plug-in-gait
`LKNE`, Rokoko, Xsens, Unreal `upperarm_l`, 3ds Max `Bip01 L Calf`, Blender `thigh.L`,
OptiTrack `LUArm`, Kinect `KneeLeft`. Case and separators do not matter.

The same word names different joints in different conventions. `LeftShoulder` is the collar bone if
there is also a `LeftArm`, but it is the upper arm if there is also a `LeftCollar`. So the aliases
of a role have an order, and the first one that a skeleton has is used.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Literal

from app.motion.roles.joint_roles import JointRole

Side = Literal["left", "right"]

_MIDDLE: dict[JointRole, tuple[str, ...]] = {
    JointRole.HIPS: ("hips", "pelvis", "spinebase", "hipcenter", "midhip", "hip"),
    JointRole.CHEST: (
        "chest", "upperchest", "thorax", "chestlower", "upperback", "spineshoulder",
        "chest4", "chest3", "chest2", "spine3", "spine2", "spine1",
    ),
    JointRole.NECK: ("neck", "necklower", "lowerneck", "neck1", "spineshoulder", "c7"),
    JointRole.HEAD: ("head", "skull"),
}  # fmt: skip
_SIDED: dict[str, tuple[str, ...]] = {
    "upper_leg": (
        "upleg", "upperleg", "legupper", "thigh", "thighbend", "femur", "hip", "hipjoint",
    ),
    "knee": ("knee", "kne", "lowerleg", "leglower", "lowleg", "shin", "calf", "tibia", "leg"),
    "foot": ("ankle", "ank", "foot"),
    "toes": ("toebase", "toes", "toe", "ball", "toetip", "foot"),
    "shoulder": (
        "upperarm", "armupper", "uparm", "uarm", "shldr", "shldrbend", "humerus", "arm",
        "shoulder", "sho",
    ),
    "elbow": (
        "elbow", "elb", "forearm", "forearmbend", "lowerarm", "armlower", "lowarm", "farm",
        "radius",
    ),
    "hand": ("wrist", "wra", "wrb", "hand"),
}  # fmt: skip
_ALIASES_WITH_SIDE = frozenset(alias for aliases in _SIDED.values() for alias in aliases)

_PREFIX = re.compile(
    r"(mixamorig\d*|bip\d*|valvebiped|cc_base|character\d*|def|org|jnt|joint|bone|bn|sk|b|j|c)"
    r"[\s_.\-]+",
    re.IGNORECASE,
)
"""Prefixes that programs add to the names of all joints."""
_FILLERS = frozenset(("joint", "jnt", "bone", "bn"))
"""Words without meaning that programs add elsewhere in the name of a joint."""
_SIDES: dict[str, Side] = {
    "left": "left", "l": "left", "lft": "left", "lt": "left",
    "right": "right", "r": "right", "rgt": "right", "rt": "right",
}  # fmt: skip
_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")


def roles_by_name(names: Sequence[str]) -> dict[JointRole, int]:
    """The joint of each role that is found by name. No joint has two roles.

    names: (joints,) parents come before their children.
    """
    keys = _first_by_key(names)
    found: dict[JointRole, int] = {}
    for role, aliases in _aliases_by_role():
        taken = set(found.values())
        candidates = (keys[alias] for alias in aliases if alias in keys)
        joint = next((joint for joint in candidates if joint not in taken), None)
        if joint is not None:
            found[role] = joint
    return found


def _aliases_by_role() -> list[tuple[JointRole, list[tuple[Side | None, str]]]]:
    table: list[tuple[JointRole, list[tuple[Side | None, str]]]] = [
        (role, [(None, alias) for alias in aliases]) for role, aliases in _MIDDLE.items()
    ]
    sides: tuple[Side, ...] = ("left", "right")
    for side in sides:
        for part, aliases in _SIDED.items():
            table.append((JointRole(f"{side}_{part}"), [(side, alias) for alias in aliases]))
    return table


def _first_by_key(names: Sequence[str]) -> dict[tuple[Side | None, str], int]:
    """The first joint, which is nearest to a root, of each side and word."""
    keys: dict[tuple[Side | None, str], int] = {}
    for joint, name in enumerate(names):
        keys.setdefault(side_and_word(name), joint)
    return keys


def side_and_word(name: str) -> tuple[Side | None, str]:
    """The side of a joint and the rest of its name: ("left", "upperarm") for `UpperArm_L`."""
    words = _words(name)
    sides = [_SIDES[word] for word in words if word in _SIDES]
    rest = "".join(word for word in words if word not in _SIDES)
    if len(sides) == 1 and rest:
        return sides[0], rest
    return _side_without_separator("".join(words))


def _words(name: str) -> list[str]:
    name_part = re.split(r"[:|]", name)[-1].strip()
    while prefix := _PREFIX.match(name_part):
        name_part = name_part[prefix.end() :]
    words = [word.lower().lstrip("0") for word in _WORD.findall(name_part)]
    return [word for word in words if word and word not in _FILLERS]


def _side_without_separator(word: str) -> tuple[Side | None, str]:
    """The side and the rest of a name without separators: `lfemur`, `rightfoot`, `LKNE`."""
    for mark, side in _SIDES.items():
        if word.startswith(mark) and word.removeprefix(mark) in _ALIASES_WITH_SIDE:
            return side, word.removeprefix(mark)
        if word.endswith(mark) and word.removesuffix(mark) in _ALIASES_WITH_SIDE:
            return side, word.removesuffix(mark)
    return None, word
