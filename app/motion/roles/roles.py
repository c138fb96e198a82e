"""Finds the joint of each role: from the client, else by names, else by the body's shape."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

from app.errors import BadField, Place
from app.motion.roles.joint_names import roles_by_name
from app.motion.roles.joint_roles import JointRole
from app.motion.roles.topology import roles_by_shape
from app.numerics.arrays import FloatArray, IntArray

_R = JointRole
_LIMBS: tuple[tuple[JointRole, ...], ...] = (
    (_R.LEFT_UPPER_LEG, _R.LEFT_KNEE, _R.LEFT_FOOT, _R.LEFT_TOES),
    (_R.RIGHT_UPPER_LEG, _R.RIGHT_KNEE, _R.RIGHT_FOOT, _R.RIGHT_TOES),
    (_R.LEFT_SHOULDER, _R.LEFT_ELBOW, _R.LEFT_HAND),
    (_R.RIGHT_SHOULDER, _R.RIGHT_ELBOW, _R.RIGHT_HAND),
    (_R.NECK, _R.HEAD),
)
"""Chains of roles: each joint must be below the one before it in the tree."""
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
    geometry. No joint gets two roles, except by `given`.
    """
    found = dict(given or {})
    tree = _Ancestry(parents)
    _add(found, tree.without_contradictions(roles_by_name(names)))
    _add(found, tree.trunk_from_limbs(found))
    if any(role not in found for role in _NEEDED):
        _add_agreeing(found, roles_by_shape(parents, positions))
    return {role: found[role] for role in JointRole if role in found}


def given_roles(names: Sequence[str], mapping: Mapping[str, str]) -> dict[JointRole, int]:
    """The joints of a client's mapping of role names to joint names.

    Raises BadField with each unknown role, unknown joint and ambiguous joint.
    """
    found: dict[JointRole, int] = {}
    places: list[Place] = []
    for role, name in mapping.items():
        problem = _problem(names, role, name)
        if problem:
            places.append(Place(f"roles.{role}", problem))
        else:
            found[JointRole(role)] = list(names).index(name)
    if places:
        raise BadField("The mapping of joint roles does not fit the skeleton", places=places)
    return found


def _problem(names: Sequence[str], role: str, name: str) -> str | None:
    if role not in tuple(JointRole):
        return f"expected one of {', '.join(JointRole)}"
    count = list(names).count(name)
    if count == 1:
        return None
    return f"expected the name of one joint, found {count} joints named {name!r}"


def _add(found: dict[JointRole, int], more: Mapping[JointRole, int]) -> None:
    """Add roles that are not found yet, for joints that have no role yet."""
    for role, joint in more.items():
        if role not in found and joint not in found.values():
            found[role] = joint


def _add_agreeing(found: dict[JointRole, int], shape: Mapping[JointRole, int]) -> None:
    """Add roles by shape. If they contradict the sides in `found`, left and right are exchanged."""
    swapped = any(
        role in found and role.mirrored() != role and shape.get(role.mirrored()) == joint
        for role, joint in found.items()
    )
    _add(found, {r.mirrored(): j for r, j in shape.items()} if swapped else shape)


class _Ancestry:
    """The parents of joints, for questions about ancestors."""

    def __init__(self, parents: IntArray) -> None:
        self.parents = [int(parent) for parent in parents]

    def above(self, joint: int) -> list[int]:
        """The joint, then its ancestors, the nearest one first."""
        found = []
        while joint >= 0:
            found.append(joint)
            joint = self.parents[joint]
        return found

    def is_tree(self) -> bool:
        """Whether some joints have parents. Markers have none, so only their names can be used."""
        return any(parent >= 0 for parent in self.parents)

    def without_contradictions(self, named: dict[JointRole, int]) -> dict[JointRole, int]:
        """`named` without limbs whose joints are not below each other in the tree.

        The hips are removed if they are not above both legs.
        """
        if not self.is_tree():
            return named
        good = dict(named)
        for limb in _LIMBS:
            chain = [role for role in limb if role in good]
            if any(good[upper] not in self.above(good[lower]) for upper, lower in pairwise(chain)):
                for role in chain:
                    del good[role]
        hips, branching = good.get(_R.HIPS), self._branching(good, _R.LEFT_KNEE)
        if hips is not None and branching is not None and hips not in self.above(branching):
            del good[_R.HIPS]
        return good

    def trunk_from_limbs(self, found: Mapping[JointRole, int]) -> dict[JointRole, int]:
        """The hips, where the legs meet; the neck, below the head or where the arms meet."""
        trunk: dict[JointRole, int] = {}
        legs, arms = (self._branching(found, r) for r in (_R.LEFT_KNEE, _R.LEFT_SHOULDER))
        if legs is not None:
            trunk[_R.HIPS] = legs
        hips = found.get(_R.HIPS, legs)
        head = found.get(_R.HEAD)
        below_head = self.parents[head] if head is not None else -1
        for joint in (below_head, -1 if arms is None else arms):
            if joint >= 0 and joint != hips and joint not in found.values():
                trunk.setdefault(_R.NECK, joint)
        return trunk

    def _branching(self, roles: Mapping[JointRole, int], left: JointRole) -> int | None:
        """The lowest joint that is above both a left role and its mirrored role."""
        if left not in roles or left.mirrored() not in roles:
            return None
        other = set(self.above(roles[left.mirrored()]))
        return next((joint for joint in self.above(roles[left]) if joint in other), None)
