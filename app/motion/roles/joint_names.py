"""Finds joint roles by the names of joints, in the common naming conventions.

These are CMU/MotionBuilder `LeftUpLeg`, ASF `lfemur`, DAZ/Poser `lShldr`, Mixamo
`mixamorig:LeftArm`, Bandai Namco `UpperArm_L`, LAFAN1, SMPL `L_Hip`, Vicon plug-in-gait
`LKNE`, Rokoko, Xsens, Unreal `upperarm_l`, 3ds Max `Bip01 L Calf`, Blender `thigh.L`,
OptiTrack `LUArm`, Kinect `KneeLeft`, Rigify `DEF-thigh.L.001`, Auto-Rig Pro `thigh_stretch.l`,
AdvancedSkeleton `Neck_M`, MakeHuman `upperleg01.L`, A.R.T. `LUAR`. Case and separators do not
matter.

The same word names different joints in different conventions. `LeftShoulder` is the collar bone if
there is also a `LeftArm`, but it is the upper arm if there is also a `LeftCollar`. So the aliases
of a role have an order, and the first one that a skeleton has is used.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

from app.motion.roles.joint_roles import JointRole

Side = Literal["left", "right"]

_MIDDLE: dict[JointRole, tuple[str, ...]] = {
    JointRole.HIPS: ("hips", "pelvis", "spinebase", "hipcenter", "midhip", "hip", "pelv"),
    JointRole.CHEST: (
        "chest", "upperchest", "thorax", "chestlower", "upperback", "spineshoulder",
        "chest4", "chest3", "chest2", "spine3", "spine2", "spine1", "utsp",
    ),
    JointRole.NECK: ("neck", "necklower", "lowerneck", "neck1", "spineshoulder", "c7"),
    JointRole.HEAD: ("head", "skull", "nose"),
}  # fmt: skip
_SIDED: dict[str, tuple[str, ...]] = {
    "upper_leg": (
        "upleg", "upperleg", "legupper", "thigh", "thighbend", "femur", "hip", "hipjoint", "ule",
    ),
    "knee": (
        "knee", "kne", "lowerleg", "leglower", "lowleg", "shin", "calf", "tibia", "leg", "lle",
    ),
    "foot": ("ankle", "ank", "foot", "foo"),
    "toes": ("toebase", "toes", "toe", "ball", "toetip", "foot"),
    "shoulder": (
        "upperarm", "armupper", "uparm", "uarm", "shldr", "shldrbend", "humerus", "arm", "uar",
        "shoulder", "sho",
    ),
    "elbow": (
        "elbow", "elb", "forearm", "forearmbend", "lowerarm", "armlower", "lowarm", "farm",
        "radius", "lar",
    ),
    "hand": ("wrist", "wra", "wrb", "hand", "han"),
}  # fmt: skip
_ALIASES_WITH_SIDE = frozenset(alias for aliases in _SIDED.values() for alias in aliases)
_ALIASES_BEFORE_SIDE = _ALIASES_WITH_SIDE - {"ule", "lle", "foo", "uar", "lar", "han"}
"""Without the words of A.R.T., which follow the side: `LLEL` is the lateral side of an elbow."""

_PREFIX = re.compile(
    r"(mixamorig\d*|bip\d*|valvebiped|cc_base|character\d*|def|org|jnt|joint|bone|bn|sk|b|j|c)"
    r"[\s_.\-]+",
    re.IGNORECASE,
)
"""Prefixes that programs add to the names of all joints."""
_FILLERS = frozenset(("joint", "jnt", "bone", "bn", "bnd", "bind", "stretch"))
"""Words without meaning that programs add elsewhere in the name of a joint."""
_LAST_FILLERS = frozenset(("j", "jt", "m", "x", "c", "mid"))
"""Words at the end of a name that mean "joint" (`L_Knee_J`) or "in the middle" (`Neck_M`)."""
_SIDES: dict[str, Side] = {
    "left": "left", "l": "left", "lft": "left", "lt": "left",
    "right": "right", "r": "right", "rgt": "right", "rt": "right",
}  # fmt: skip
_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")
_NUMBER = re.compile(r"(?<=[a-z])\d+$")
KEPT_SKELETONS = 64
"""The joints of so many skeletons are kept, because many clips have the same one."""
_MIDDLE_WITH_NUMBER = (JointRole.NECK, JointRole.HEAD)
"""Roles of the middle for which `neck2` may stand. The number of a spine joint has a meaning."""


@dataclass(frozen=True, slots=True)
class NamedJoint:
    """A joint that a role may have by its name. rank: of the alias, 0 for the best one."""

    joint: int
    rank: int


def joints_by_name(names: Sequence[str]) -> Mapping[JointRole, Sequence[NamedJoint]]:
    """The joints that each role may have by their names, the best alias first.

    names: (joints,) parents come before their children. Of the joints with one alias, those whose
    names have no number come first, and then those nearest to a root. Blender adds numbers to the
    names of copies, and programs add them to the parts of a split limb.
    """
    return _joints_by_name(tuple(names))


@lru_cache(maxsize=KEPT_SKELETONS)
def _joints_by_name(names: tuple[str, ...]) -> Mapping[JointRole, Sequence[NamedJoint]]:
    exact, numbered = _joints_by_key(names)
    found: dict[JointRole, Sequence[NamedJoint]] = {}
    for role, aliases in _aliases_by_role():
        with_number = aliases[0][0] is not None or role in _MIDDLE_WITH_NUMBER
        joints = [
            NamedJoint(joint, rank)
            for rank, alias in enumerate(aliases)
            for joint in (*exact.get(alias, ()), *(numbered.get(alias, ()) if with_number else ()))
        ]
        if joints:
            found[role] = joints
    return found


def roles_by_name(names: Sequence[str]) -> dict[JointRole, int]:
    """The joint of each role that is found by name. No joint has two roles.

    names: (joints,) parents come before their children.
    """
    found: dict[JointRole, int] = {}
    for role, joints in joints_by_name(names).items():
        taken = set(found.values())
        free = next((named.joint for named in joints if named.joint not in taken), None)
        if free is not None:
            found[role] = free
    return found


_Key = tuple[Side | None, str]


def _aliases_by_role() -> list[tuple[JointRole, list[_Key]]]:
    table: list[tuple[JointRole, list[_Key]]] = [
        (role, [(None, alias) for alias in aliases]) for role, aliases in _MIDDLE.items()
    ]
    sides: tuple[Side, ...] = ("left", "right")
    for side in sides:
        for part, aliases in _SIDED.items():
            table.append((JointRole(f"{side}_{part}"), [(side, alias) for alias in aliases]))
    return table


def _joints_by_key(names: Sequence[str]) -> tuple[dict[_Key, list[int]], dict[_Key, list[int]]]:
    """The joints of each side and word: with this word, and with a number behind it."""
    exact: dict[_Key, list[int]] = {}
    numbered: dict[_Key, list[int]] = {}
    for joint, name in enumerate(names):
        side, word = side_and_word(name)
        exact.setdefault((side, word), []).append(joint)
        bare = _NUMBER.sub("", word)
        if bare != word:
            key = (side, bare) if side is not None else _side_without_separator(bare)
            numbered.setdefault(key, []).append(joint)
    return exact, numbered


@lru_cache(maxsize=4096)
def side_and_word(name: str) -> tuple[Side | None, str]:
    """The side of a joint and the rest of its name: ("left", "upperarm") for `UpperArm_L`."""
    words = words_of_name(name)
    sides = [_SIDES[word] for word in words if word in _SIDES]
    rest = "".join(word for word in words if word not in _SIDES)
    if len(sides) == 1 and rest:
        return sides[0], rest
    return _side_without_separator("".join(words))


@lru_cache(maxsize=4096)
def words_of_name(name: str) -> tuple[str, ...]:
    """The words of a joint's name in lower case, without prefixes: ("upper", "arm", "l").

    Many clips have the same skeleton, so the words of names are kept.
    """
    name_part = re.split(r"[:|]", name)[-1].strip()
    while prefix := _PREFIX.match(name_part):
        name_part = name_part[prefix.end() :]
    words = [word.lower().lstrip("0") for word in _WORD.findall(name_part)]
    words = [word for word in words if word and word not in _FILLERS]
    while len(words) > 1 and words[-1] in _LAST_FILLERS:
        words.pop()
    return tuple(words)


def _side_without_separator(word: str) -> tuple[Side | None, str]:
    """The side and the rest of a name without separators: `lfemur`, `rightfoot`, `LKNE`."""
    for mark, side in _SIDES.items():
        if word.startswith(mark) and word.removeprefix(mark) in _ALIASES_WITH_SIDE:
            return side, word.removeprefix(mark)
        if word.endswith(mark) and word.removesuffix(mark) in _ALIASES_BEFORE_SIDE:
            return side, word.removesuffix(mark)
    return None, word
