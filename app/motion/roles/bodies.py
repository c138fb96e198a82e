"""Finds the joint roles of one body if a file has several bodies.

A skeleton may have several roots, which belong to people, props or single markers. The roles of two
people must not be mixed. So if two trees of joints are bodies, the roles are found in one of them,
and a caution names the others.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from app.motion.roles.joint_roles import ESSENTIAL_ROLES, JointRole
from app.motion.roles.roles import find_roles
from app.motion.skeleton.kinematics import joints_by_depth
from app.motion.skeleton.recording import Caution
from app.numerics.arrays import FloatArray, IntArray

MIN_JOINTS = 8
"""The fewest joints of a person. A smaller tree is an object or a set of markers."""

Roles = dict[JointRole, int]


def roles_of_one_body(
    names: Sequence[str],
    parents: IntArray,
    positions: FloatArray,
    given: Mapping[JointRole, int],
) -> tuple[Roles, tuple[Caution, ...]]:
    """The joint of each role, all of one body, and a caution if there are other bodies.

    names, parents: (joints,). positions: (frames, joints, 3) in any unit and axes. given: joints
    that a client named. The body with the most of these joints is used, and else the first body.
    """
    found = _bodies(names, parents, positions)
    if len(found) < 2:
        return find_roles(names, parents, positions, given), ()
    ours = max(found, key=lambda joints: len(set(joints.tolist()) & set(given.values())))
    others = ", ".join(names[int(joints[0])] for joints in found if joints is not ours)
    detail = (
        f"the file has {len(found)} people; the one with the root {names[int(ours[0])]} is used, "
        f"left out: {others}"
    )
    roles = _roles_in(ours, names, parents, positions) | dict(given)
    return roles, (Caution("several_people", detail, joint=names[int(ours[0])]),)


def _bodies(names: Sequence[str], parents: IntArray, positions: FloatArray) -> list[IntArray]:
    """The trees that have all ESSENTIAL_ROLES, each as its joints, the root first."""
    if np.count_nonzero(parents < 0) < 2:
        return []
    root_of = _roots(parents)
    roots = np.flatnonzero(np.bincount(root_of) >= MIN_JOINTS)
    if len(roots) < 2:
        return []
    large = [np.flatnonzero(root_of == root) for root in roots]
    return [tree for tree in large if _is_body(_roles_in(tree, names, parents, positions))]


def _is_body(roles: Roles) -> bool:
    return all(role in roles for role in ESSENTIAL_ROLES)


def _roles_in(
    joints: IntArray, names: Sequence[str], parents: IntArray, positions: FloatArray
) -> Roles:
    """The roles that are found in one tree, as joints of the whole skeleton."""
    new_index = {joint: index for index, joint in enumerate(joints.tolist())}
    tree_parents = np.array([new_index.get(int(parent), -1) for parent in parents[joints]])
    found = find_roles([names[joint] for joint in joints], tree_parents, positions[:, joints])
    return {role: int(joints[index]) for role, index in found.items()}


def _roots(parents: IntArray) -> IntArray:
    """(joints,) the root of the tree of each joint."""
    roots = np.arange(len(parents))
    for joints in joints_by_depth(parents)[1:]:
        roots[joints] = roots[parents[joints]]
    return roots
