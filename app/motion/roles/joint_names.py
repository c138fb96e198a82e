"""What a joint's name says about its role, in the common naming conventions.

CMU/MotionBuilder `LeftUpLeg`, ASF `lfemur`, DAZ/Poser `lShldr`, Mixamo
`mixamorig:LeftArm`, Bandai Namco `UpperArm_L`, LAFAN1, SMPL `L_Hip`, Vicon plug-in-gait
`LKNE`, Rokoko, Xsens, Unreal `upperarm_l`, 3ds Max `Bip01 L Calf`, Blender `thigh.L`,
OptiTrack `LUArm`, Kinect `KneeLeft`. Case and separators do not matter.

The same word means different joints in different conventions (`LeftShoulder` is the
collar bone beside `LeftArm`, the upper arm beside `LeftCollar`), so aliases are ordered:
the first that a skeleton has is taken.
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
"""What rigs put before every joint's name."""
_NOISE = frozenset(("joint", "jnt", "bone", "bn"))
"""What rigs put elsewhere in a joint's name."""
_SIDES: dict[str, Side] = {
    "left": "left", "l": "left", "lft": "left",
    "right": "right", "r": "right", "rgt": "right",
}  # fmt: skip
_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")


def roles_by_name(names: Sequence[str]) -> dict[JointRole, int]:
    """The joint of each role that is found by name; no joint has two roles."""
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
    """The first joint (nearest to a root) of each side and word."""
    keys: dict[tuple[Side | None, str], int] = {}
    for joint, name in enumerate(names):
        keys.setdefault(side_and_word(name), joint)
    return keys


def side_and_word(name: str) -> tuple[Side | None, str]:
    """A joint's side and the rest of its name, e.g. ("left", "upperarm") for `UpperArm_L`."""
    words = _words(name)
    sides = [_SIDES[word] for word in words if word in _SIDES]
    rest = "".join(word for word in words if word not in _SIDES)
    if len(sides) == 1 and rest:
        return sides[0], rest
    return _glued("".join(words))


def _words(name: str) -> list[str]:
    local = re.split(r"[:|]", name)[-1].strip()
    while prefix := _PREFIX.match(local):
        local = local[prefix.end() :]
    words = [word.lower().lstrip("0") for word in _WORD.findall(local)]
    return [word for word in words if word and word not in _NOISE]


def _glued(word: str) -> tuple[Side | None, str]:
    """Side letters without a separator: `lfemur`, `rightfoot`, `LKNE`, `luarm`."""
    for mark, side in _SIDES.items():
        if word.startswith(mark) and word.removeprefix(mark) in _ALIASES_WITH_SIDE:
            return side, word.removeprefix(mark)
        if word.endswith(mark) and word.removesuffix(mark) in _ALIASES_WITH_SIDE:
            return side, word.removesuffix(mark)
    return None, word
