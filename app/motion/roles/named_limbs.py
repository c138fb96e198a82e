"""Chooses the joints of limbs among those that their names allow.

Several joints may have the name of one role: the copies of a skeleton in one file, the parts of a
split limb (`thigh.L`, `thigh.L.001`), a collar bone that is called shoulder, a helper joint in the
hips that is called hip. The joints of one limb must be below each other. Among the possible limbs,
the one with the most roles is chosen, then the one with the better aliases.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations, pairwise, product

import numpy as np

from app.motion.roles.joint_names import KEPT_SKELETONS, NamedJoint, joints_by_name
from app.motion.roles.joint_roles import JointRole
from app.motion.roles.tree import Tree
from app.numerics.arrays import FloatArray

_R = JointRole
LIMBS: tuple[tuple[JointRole, ...], ...] = (
    (_R.LEFT_UPPER_LEG, _R.LEFT_KNEE, _R.LEFT_FOOT, _R.LEFT_TOES),
    (_R.RIGHT_UPPER_LEG, _R.RIGHT_KNEE, _R.RIGHT_FOOT, _R.RIGHT_TOES),
    (_R.LEFT_SHOULDER, _R.LEFT_ELBOW, _R.LEFT_HAND),
    (_R.RIGHT_SHOULDER, _R.RIGHT_ELBOW, _R.RIGHT_HAND),
    (_R.NECK, _R.HEAD),
)
"""Chains of roles: each joint must be below the one before it in the tree."""
_STARTS = (_R.LEFT_UPPER_LEG, _R.RIGHT_UPPER_LEG, _R.LEFT_SHOULDER, _R.RIGHT_SHOULDER)
MAX_JOINTS_OF_ROLE = 4
"""The most joints of one role and alias that are tried: 256 limbs of four roles."""
MIN_NUMBERED = 2
"""The fewest joints of one name in a chain, so that it is the name of the limb: `leg_01`,
`leg_02`."""
MIN_STRAIGHTNESS = 0.98
"""The smallest share of the way along the bones of a split thigh that its ends are apart."""

Named = Mapping[JointRole, Sequence[NamedJoint]]


@dataclass(frozen=True, slots=True)
class _Limb:
    """The best choice for a limb, and the joints that were tried for its first role."""

    best: Mapping[JointRole, NamedJoint]
    starts: Sequence[NamedJoint]


def limbs_by_name(names: Sequence[str], tree: Tree, positions: FloatArray) -> dict[JointRole, int]:
    """The joint of each role of the limbs, neck and head that is found by name.

    names: (joints,). positions: (frames, joints, 3), some frames. Roles of a limb whose joints
    cannot be below the others are left out.
    """
    found: dict[JointRole, int] = {}
    for limb in _limbs(tuple(names), tuple(tree.parents)):
        found |= _from_its_start(limb, tree, positions)
    return found


@lru_cache(maxsize=KEPT_SKELETONS)
def _limbs(names: tuple[str, ...], parents: tuple[int, ...]) -> Sequence[_Limb]:
    named, tree = joints_by_name(names), Tree(parents)
    limbs = (_best_limb(limb, named, tree) for limb in LIMBS if not _is_numbered(limb, named, tree))
    return [limb for limb in limbs if limb is not None]


def _is_numbered(limb: Sequence[JointRole], named: Named, tree: Tree) -> bool:
    """Whether all joints of a limb have one name and a number, so that its shape must decide."""
    upper = limb[:2]
    if all(role in named for role in upper):
        return False
    joints = {each.joint for role in upper for each in named.get(role, ())}
    return any(len(joints.intersection(tree.above(joint))) >= MIN_NUMBERED for joint in joints)


def _best_limb(limb: Sequence[JointRole], named: Named, tree: Tree) -> _Limb | None:
    """The joints of one limb: the choice with the most roles, then that with the best aliases."""
    roles = [role for role in limb if role in named]
    choices = [_tried(named[role]) for role in roles]
    for left_out in range(len(roles)):
        good = [
            dict(zip(kept, choice, strict=True))
            for kept, kept_choices in _leaving_out(left_out, roles, choices)
            for choice in product(*kept_choices)
            if _is_limb(choice, tree)
        ]
        if good:
            best = min(good, key=lambda choice: sum(each.rank for each in choice.values()))
            return _Limb(best, dict(zip(roles, choices, strict=True))[next(iter(best))])
    return None


def _leaving_out(
    count: int, roles: Sequence[JointRole], choices: Sequence[list[NamedJoint]]
) -> Iterator[tuple[list[JointRole], list[list[NamedJoint]]]]:
    """The roles and their choices without `count` of the roles, the outer ones first."""
    pairs = list(zip(roles, choices, strict=True))
    for kept in combinations(pairs, len(pairs) - count):
        yield [role for role, _ in kept], [choice for _, choice in kept]


def _from_its_start(limb: _Limb, tree: Tree, positions: FloatArray) -> dict[JointRole, int]:
    """The joints of a limb, with the joint at the anatomical hip or shoulder as its start."""
    found = {role: named.joint for role, named in limb.best.items()}
    first, *others = found
    if others and first in _STARTS:
        same = [named.joint for named in limb.starts if named.rank == limb.best[first].rank]
        found[first] = _start_of_limb(same, found[others[0]], tree, positions)
    return found


def _tried(joints: Sequence[NamedJoint]) -> list[NamedJoint]:
    """The first joints of each alias."""
    count: dict[int, int] = {}
    tried = []
    for named in joints:
        count[named.rank] = count.get(named.rank, 0) + 1
        if count[named.rank] <= MAX_JOINTS_OF_ROLE:
            tried.append(named)
    return tried


def _is_limb(choice: Sequence[NamedJoint], tree: Tree) -> bool:
    """Whether each joint is below the one before it."""
    joints = [named.joint for named in choice]
    return all(upper != lower and upper in tree.above(lower) for upper, lower in pairwise(joints))


def _start_of_limb(
    joints: Sequence[int], next_joint: int, tree: Tree, positions: FloatArray
) -> int:
    """The joint at the anatomical hip or shoulder, among joints of one name above `next_joint`.

    It is the uppermost one from which the bones are straight. The bones of a split thigh are
    straight; those through a helper joint in the middle of the hips are not.
    """
    above = [joint for joint in tree.above(next_joint)[1:] if joint in joints]
    if len(above) == 1:
        return above[0]
    straight = [joint for joint in above if _is_straight(joint, next_joint, tree, positions)]
    return straight[-1] if straight else above[0]


def _is_straight(upper: int, lower: int, tree: Tree, positions: FloatArray) -> bool:
    way = positions[:, tree.between(upper, lower)]
    length = np.linalg.norm(np.diff(way, axis=1), axis=-1).sum(axis=1)
    apart = np.linalg.norm(way[:, -1] - way[:, 0], axis=-1)
    return bool(np.median(apart) >= MIN_STRAIGHTNESS * np.median(length))
