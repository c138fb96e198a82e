"""Questions about the ancestors of joints."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from app.motion.roles.joint_roles import JointRole


class Tree:
    """The parents of joints. parents: (joints,) -1 for a root."""

    def __init__(self, parents: Iterable[int]) -> None:
        self.parents = [int(parent) for parent in parents]
        self.children: list[list[int]] = [[] for _ in self.parents]
        for joint, parent in enumerate(self.parents):
            if parent >= 0:
                self.children[parent].append(joint)

    def above(self, joint: int) -> list[int]:
        """The joint, then its ancestors, the nearest one first."""
        found = []
        while joint >= 0:
            found.append(joint)
            joint = self.parents[joint]
        return found

    def between(self, upper: int, lower: int) -> list[int]:
        """The joints from `upper` to `lower`, both included; empty if that is not below."""
        way = self.above(lower)
        return way[way.index(upper) :: -1] if upper in way else []

    def is_tree(self) -> bool:
        """Whether some joints have parents. Markers have none, so only their names can be used."""
        return any(parent >= 0 for parent in self.parents)

    def branching(self, roles: Mapping[JointRole, int], left: JointRole) -> int | None:
        """The lowest joint that is above both a left role and its mirrored role."""
        if left not in roles or left.mirrored() not in roles:
            return None
        other = set(self.above(roles[left.mirrored()]))
        return next((joint for joint in self.above(roles[left]) if joint in other), None)
