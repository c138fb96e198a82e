"""Finds hips, neck and head in the tree, if the limbs are known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from app.motion.roles.joint_roles import JointRole
from app.motion.roles.tree import Tree
from app.numerics.arrays import FloatArray

_R = JointRole


@dataclass(frozen=True, slots=True)
class Trunk:
    """What the trunk is found from.

    sides: (joints,) the side in each joint's name, or None. positions: (frames, joints, 3), some
    frames.
    """

    tree: Tree
    sides: Sequence[str | None]
    positions: FloatArray

    def roles(self, found: Mapping[JointRole, int]) -> dict[JointRole, int]:
        """The hips, where the legs meet; the head; and the neck, between arms and head.

        found: the roles of the limbs. Without a joint between the arms and the head, the joint
        where the arms part and the head hangs is the neck.
        """
        trunk: dict[JointRole, int] = {}
        legs = self._first_branching(found, (_R.LEFT_UPPER_LEG, _R.LEFT_KNEE))
        if legs is not None:
            trunk[_R.HIPS] = legs
        hips = found.get(_R.HIPS, legs)
        arms = self._first_branching(found, (_R.LEFT_SHOULDER, _R.LEFT_ELBOW))
        if arms is not None and arms in self.tree.above(-1 if hips is None else hips):
            arms = None
        head = found.get(_R.HEAD)
        if head is None and arms is not None:
            column = self._column(arms, found)
            head = column[-1] if column else None
            if head is not None:
                trunk[_R.HEAD] = head
        neck = self._neck(arms, head, found)
        if neck is not None and neck not in (hips, head):
            trunk[_R.NECK] = neck
        return trunk

    def _first_branching(
        self, found: Mapping[JointRole, int], left: Sequence[JointRole]
    ) -> int | None:
        joints = (self.tree.branching(found, role) for role in left)
        return next((joint for joint in joints if joint is not None), None)

    def _neck(
        self, arms: int | None, head: int | None, found: Mapping[JointRole, int]
    ) -> int | None:
        """Between the joint where the arms part and the head; the joint nearest to the shoulders.

        Without arms, it is the parent of the head.
        """
        if head is None:
            return arms
        between = [] if arms is None else self.tree.between(arms, head)[1:-1]
        if not between:
            return self.tree.parents[head] if arms is None else arms
        shoulders = [found[role] for role in (_R.LEFT_SHOULDER, _R.RIGHT_SHOULDER) if role in found]
        if not shoulders:
            return between[0]
        middle = self.positions[:, shoulders].mean(axis=1)
        away = np.linalg.norm(self.positions[:, between] - middle[:, None], axis=-1)
        return between[int(np.argmin(np.median(away, axis=0)))]

    def _column(self, arms: int, found: Mapping[JointRole, int]) -> list[int]:
        """The joints without a side from the parting of the arms to the top of the head.

        The longest chain is used. It ends where the joints of a face begin.
        """
        limbs = {joint for role in found for joint in self.tree.above(found[role])}
        starts = [
            child
            for child in self.tree.children[arms]
            if child not in limbs and self.sides[child] is None
        ]
        chains = [self._unbranched(start) for start in starts]
        return max(chains, key=self._length, default=[])

    def _unbranched(self, joint: int) -> list[int]:
        column = [joint]
        while len(self.tree.children[column[-1]]) == 1:
            column += self.tree.children[column[-1]]
        return column

    def _length(self, chain: Sequence[int]) -> float:
        first = self.tree.parents[chain[0]]
        way = self.positions[:, [first, *chain]]
        return float(np.median(np.linalg.norm(np.diff(way, axis=1), axis=-1).sum(axis=1)))
