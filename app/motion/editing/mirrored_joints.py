"""Finds the joint on the other side of the body for each joint of a skeleton."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from app.motion.roles.joint_roles import JointRole
from app.motion.roles.sided_texts import with_case_of
from app.numerics.arrays import IntArray

_OTHER_SIDE = {"left": "right", "right": "left", "l": "r", "r": "l"}
_MARK = re.compile(
    r"left|right"  # anywhere
    r"|(?<![a-z])[lr](?![a-z])"  # alone between other characters, as in `Arm_L`
    r"|^[lr]|[lr]$",  # at an end, as in `lhipjoint`
    re.IGNORECASE,
)


def mirrored_joints(names: Sequence[str], roles: Mapping[JointRole, int]) -> IntArray:
    """(joints,) the joint on the other side of each joint; a joint of the middle is its own.

    names: (joints,). roles: the joints whose role is known, which pair first. The others pair if
    their names differ only in a mark of the side: Left and Right, L and R.
    """
    other = np.arange(len(names))
    for role, joint in roles.items():
        other[joint] = roles.get(role.mirrored(), joint)
    by_name = {name: joint for joint, name in enumerate(names)}
    for joint, name in enumerate(names):
        if joint in roles.values():
            continue
        for mirrored in _mirrored_names(name):
            found = by_name.get(mirrored, joint)
            if found != joint and found not in roles.values() and other[found] in (found, joint):
                other[joint], other[found] = found, joint
                break
    return other


def _mirrored_names(name: str) -> Iterator[str]:
    """The names that the joint on the other side may have; each changes one mark."""
    for mark in _MARK.finditer(name):
        yield name[: mark.start()] + with_case_of(mark[0], _OTHER_SIDE) + name[mark.end() :]
