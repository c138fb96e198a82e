"""Finds the joint of each role: from the client, else by names, else by the body's shape."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from app.errors import BadField
from app.kinedex_error import Place
from app.motion.roles.joint_names import joints_by_name, roles_by_name, side_and_word
from app.motion.roles.joint_roles import JointRole
from app.motion.roles.named_limbs import limbs_by_name
from app.motion.roles.topology import MAX_SAMPLED_FRAMES, roles_by_shape
from app.motion.roles.tree import Tree
from app.motion.roles.trunk import Trunk
from app.motion.skeleton.resampling import some_frames
from app.numerics.arrays import FloatArray, IntArray

_R = JointRole
MAX_JOINTS_OF_MIDDLE = 2
"""The most joints that a client may name for one role. Their middle is used."""
_NEEDED = tuple(role for role in JointRole if role not in (_R.CHEST, _R.LEFT_TOES, _R.RIGHT_TOES))
"""If one of these roles is not found by name, the shape of the body is used."""


def find_roles(
    names: Sequence[str],
    parents: IntArray,
    positions: FloatArray,
    given: Mapping[JointRole, int] | None = None,
) -> dict[JointRole, int]:
    """The joint of each role; roles that cannot be found are left out.

    names, parents: (joints,). positions: (frames, joints, 3) in any unit and axes. given: the
    joints of roles that a client named; they have priority. Sides in names have priority over
    geometry: no joint gets a role of the other side. No joint gets two roles, except by `given`.
    """
    tree = Tree(parents)
    sampled = some_frames(positions, MAX_SAMPLED_FRAMES).astype(np.float64)
    sides = [side_and_word(name)[0] for name in names]
    found = dict(given or {})
    _add(found, _by_name(names, tree, sampled))
    if tree.is_tree():
        _add_trunk(found, Trunk(tree, sides, sampled).roles(found))
    if any(role not in found for role in _NEEDED):
        _add_agreeing(found, roles_by_shape(parents, sampled), sides)
    return {role: found[role] for role in JointRole if role in found}


def _by_name(names: Sequence[str], tree: Tree, positions: FloatArray) -> dict[JointRole, int]:
    """The roles by name. In a tree, the joints of a limb are below each other."""
    if not tree.is_tree():
        return roles_by_name(names)
    named = joints_by_name(names)
    found = limbs_by_name(names, tree, positions)
    for role in (_R.HIPS, _R.CHEST):
        joints = (each.joint for each in named.get(role, ()))
        joint = next((joint for joint in joints if joint not in found.values()), None)
        if joint is not None:
            found[role] = joint
    legs = tree.branching(found, _R.LEFT_KNEE)
    if _R.HIPS in found and legs is not None and found[_R.HIPS] not in tree.above(legs):
        del found[_R.HIPS]
    return found


def _add_trunk(found: dict[JointRole, int], trunk: Mapping[JointRole, int]) -> None:
    """Add the roles of the trunk. The neck may be a joint that its name makes the chest."""
    neck = trunk.get(_R.NECK)
    if _R.NECK not in found and neck is not None and found.get(_R.CHEST) == neck:
        del found[_R.CHEST]
    _add(found, trunk)


def given_roles(
    names: Sequence[str], mapping: Mapping[str, str | Sequence[str]]
) -> dict[JointRole, tuple[int, ...]]:
    """The joints of a client's mapping of role names to joint names.

    A role has one joint, or two joints whose middle is meant. Raises BadField with each unknown
    role, unknown joint and ambiguous joint.
    """
    found: dict[JointRole, tuple[int, ...]] = {}
    places: list[Place] = []
    for role, said in mapping.items():
        joints = [said] if isinstance(said, str) else list(said)
        problem = _problem(names, role, joints)
        if problem:
            places.append(Place(f"roles.{role}", problem))
        else:
            found[JointRole(role)] = tuple(list(names).index(name) for name in joints)
    if places:
        raise BadField("The mapping of joint roles does not fit the skeleton", places=places)
    return found


def _problem(names: Sequence[str], role: str, joints: Sequence[str]) -> str | None:
    if role not in tuple(JointRole):
        return f"expected one of {', '.join(JointRole)}"
    if not 1 <= len(joints) <= MAX_JOINTS_OF_MIDDLE:
        return f"expected one joint, or two for their middle, found {len(joints)}"
    for name in joints:
        count = list(names).count(name)
        if count != 1:
            return f"expected the name of one joint, found {count} joints named {name!r}"
    return None


def _add(found: dict[JointRole, int], more: Mapping[JointRole, int]) -> None:
    """Add roles that are not found yet, for joints that have no role yet."""
    for role, joint in more.items():
        if role not in found and joint not in found.values():
            found[role] = joint


def _add_agreeing(
    found: dict[JointRole, int], shape: Mapping[JointRole, int], sides: Sequence[str | None]
) -> None:
    """Add roles by shape. If they contradict the sides in names, left and right are exchanged.

    sides: (joints,) the side in each joint's name. A role that still contradicts is left out.
    """
    swapped = any(
        role in found and role.mirrored() != role and shape.get(role.mirrored()) == joint
        for role, joint in found.items()
    )
    against = sum(_contradicts(role, sides[joint]) for role, joint in shape.items())
    agreeing = sum(_agrees(role, sides[joint]) for role, joint in shape.items())
    if swapped or against > agreeing:
        shape = {role.mirrored(): joint for role, joint in shape.items()}
    _add(found, {r: j for r, j in shape.items() if not _contradicts(r, sides[j])})


def _agrees(role: JointRole, side: str | None) -> bool:
    return side is not None and role.startswith(f"{side}_")


def _contradicts(role: JointRole, side: str | None) -> bool:
    return side is not None and role.mirrored() is not role and not role.startswith(f"{side}_")
