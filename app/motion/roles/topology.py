"""Finds joint roles by the shape of a skeleton, if its names give none.

Legs and arms are two pairs of mirrored chains of bones. Each chain has two long neighboring bones:
thigh and shank are .49 of the stature, and upper arm and forearm are .33 (Drillis and Contini 1966;
fig. 4.1 of Winter, "Biomechanics and motor control"). Legs are the longest pair. Left is the cross
product of up (along the trunk) and forward (where the toes point and the knees bend). A mirrored
motion gets mirrored roles.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np

from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.resampling import some_frames
from app.numerics.arrays import FloatArray, IntArray

MAX_SAMPLED_FRAMES = 64
"""The most frames, evenly spaced, in which shape and sides are measured."""
MIN_MIRROR_RATIO = 0.85
"""The smallest ratio of the lengths of two mirrored bones (shorter / longer)."""
MIN_LONGEST_SHARE = 0.85
"""Pairs of bones with at least this share of the longest pair count as equally long."""
MIN_BONE_SHARE = 0.02
"""A bone with a smaller share of its chain has no length: its two joints are one."""
MIN_ARM_SHARE = 0.35
"""Upper arm and forearm have at least this share of the length of thigh and shank."""
MIN_SIDE_EVIDENCE = 0.02
"""Left and right are decided only if the evidence is at least this share of its possible size."""
MAX_PAIRED_CHILDREN = 12
"""The most children of a joint that are compared in pairs. Bodies have fewer branches."""


@dataclass(frozen=True, slots=True)
class _Chain:
    """A limb, from the joint where it leaves the trunk, outward.

    branch: the first joint that belongs to the limb alone. joints: (bones + 1,) bone i is from
    joint i to joint i + 1. lengths: (bones,).
    """

    branch: int
    joints: tuple[int, ...]
    lengths: tuple[float, ...]

    def main_bones(self) -> int:
        """The index of the first of the two main bones: the longest two neighbors.

        A collar bone can be as long as a forearm. So if pairs are nearly equally long, the
        outermost pair is used.
        """
        sums = np.array([a + b for a, b in pairwise(self.lengths)])
        return int(np.flatnonzero(sums >= MIN_LONGEST_SHARE * sums.max())[-1])

    def reach(self) -> float:
        """The length of the two main bones."""
        first = self.main_bones()
        return self.lengths[first] + self.lengths[first + 1]


_Pair = tuple[int, _Chain, _Chain]
"""The joint where two mirrored chains leave the trunk, and the two chains."""


def roles_by_shape(parents: IntArray, positions: FloatArray) -> dict[JointRole, int]:
    """The joint of each role, by the shape of the body.

    parents: (joints,) -1 for a root. positions: (frames, joints, 3) in any unit and axes. The
    result is empty if there are no legs. Limbs are left out if their side is unclear.
    """
    tree = _Tree(parents, some_frames(positions, MAX_SAMPLED_FRAMES).astype(np.float64))
    pairs = sorted(tree.mirrored_pairs(), key=lambda pair: -pair[1].reach())
    if not pairs:
        return {}
    legs = pairs[0]
    arms = next((pair for pair in pairs[1:] if tree.could_be_arms(legs, pair)), None)
    roles = tree.trunk_roles(legs, arms)
    left = _left_of_body(roles, tree.positions, legs)
    for pair, parts in ((legs, _LEG), (arms, _ARM)):
        sided = _left_first(pair, tree.positions, left) if pair and left is not None else None
        if sided is not None:
            roles |= _limb_roles(sided, parts)
    return roles


class _Tree:
    """The tree of joints. length: (joints,) of the bone to each joint. reach: (joints,) the longest
    way outward from each joint."""

    def __init__(self, parents: IntArray, positions: FloatArray) -> None:
        self.parents = parents
        self.positions = positions
        self.children: list[list[int]] = [[] for _ in parents]
        bones = positions - positions[:, np.maximum(parents, 0)]
        self.length = np.median(np.linalg.norm(bones, axis=-1), axis=0)
        self.reach = np.zeros(len(parents))
        for joint in range(len(parents) - 1, -1, -1):
            parent = int(parents[joint])
            if parent >= 0:
                self.children[parent].insert(0, joint)
                along = self.length[joint] + self.reach[joint]
                self.reach[parent] = max(self.reach[parent], along)

    def mirrored_pairs(self) -> Iterator[_Pair]:
        """All pairs of similar chains with at least two bones that leave the trunk at one joint."""
        for joint, children in enumerate(self.children):
            chains = [self.chain(joint, child) for child in children[:MAX_PAIRED_CHILDREN]]
            for one, other in combinations(chains, 2):
                if _are_mirrored(one, other):
                    yield joint, one, other

    def chain(self, start: int, child: int) -> _Chain:
        """The longest chain from `start` through `child` outward, without bones of no length."""
        path = [start, child]
        while self.children[path[-1]]:
            onward = self.children[path[-1]]
            path.append(max(onward, key=lambda joint: self.length[joint] + self.reach[joint]))
        small = MIN_BONE_SHARE * float(self.length[path[1:]].sum())
        joints, lengths = [start], []
        for joint in path[1:]:
            if self.length[joint] <= small:
                joints[-1] = joint
            else:
                joints.append(joint)
                lengths.append(float(self.length[joint]))
        return _Chain(child, tuple(joints), tuple(lengths))

    def could_be_arms(self, legs: _Pair, arms: _Pair) -> bool:
        """Whether the chains are long enough, and share no joint with the legs."""
        if arms[1].reach() < MIN_ARM_SHARE * legs[1].reach():
            return False
        taken = {joint for chain in legs[1:] for joint in chain.joints if joint != legs[0]}
        others = {joint for chain in arms[1:] for joint in chain.joints if joint != arms[0]}
        return not taken & (others | {arms[0]})

    def trunk_roles(self, legs: _Pair, arms: _Pair | None) -> dict[JointRole, int]:
        """Hips, chest, neck and head.

        Neck and head are on the longest chain from the joint where the arms (or else the legs)
        meet.
        """
        found = {JointRole.HIPS: legs[0]}
        top, *limbs = legs if arms is None else arms
        if top != legs[0]:
            found[JointRole.CHEST] = top
        taken = {limb.branch for limb in (*limbs, *legs[1:])} | self._ancestors(legs[0])
        free = [child for child in self.children[top] if child not in taken]
        if not free:
            return found
        column = self._unbranched(max(free, key=lambda j: self.length[j] + self.reach[j]))
        if arms is None:
            column = column[-2:]
        neck = column[0] if len(column) > 1 else top
        if neck != legs[0]:
            found[JointRole.NECK] = neck
        return found | {JointRole.HEAD: column[-1]}

    def _ancestors(self, joint: int) -> set[int]:
        """The joint and all above it."""
        found = set()
        while joint >= 0:
            found.add(joint)
            joint = int(self.parents[joint])
        return found

    def _unbranched(self, joint: int) -> list[int]:
        column = [joint]
        while len(self.children[column[-1]]) == 1:
            column += self.children[column[-1]]
        return column


def _are_mirrored(one: _Chain, other: _Chain) -> bool:
    """Whether the main bones of two chains are mirrored. Later bones may be of other fingers."""
    if min(len(one.lengths), len(other.lengths)) < 2 or one.main_bones() != other.main_bones():
        return False
    main = slice(one.main_bones(), one.main_bones() + 2)
    pairs = zip(one.lengths[main], other.lengths[main], strict=True)
    return all(min(pair) >= MIN_MIRROR_RATIO * max(pair) for pair in pairs)


def _left_of_body(
    trunk: dict[JointRole, int], positions: FloatArray, legs: _Pair
) -> FloatArray | None:
    """(frames, 3) a vector to the left of the body; None if there is no trunk."""
    top = trunk.get(JointRole.NECK, trunk.get(JointRole.CHEST))
    if top is None:
        return None
    up = positions[:, top] - positions[:, legs[0]]
    forward = sum(_forward_of_leg(chain, positions) for chain in legs[1:])
    return np.cross(up, forward)


def _forward_of_leg(chain: _Chain, positions: FloatArray) -> FloatArray:
    """(frames, 3) a vector forward: from the ankle to the toes, plus from the leg to the knee."""
    first = chain.main_bones()
    hip, knee, ankle = (positions[:, joint] for joint in chain.joints[first : first + 3])
    leg = ankle - hip
    along = np.sum((knee - hip) * leg, axis=-1) / np.maximum(np.sum(leg * leg, axis=-1), 1e-12)
    bend = knee - hip - along[:, None] * leg
    toes = positions[:, chain.joints[min(first + 3, len(chain.joints) - 1)]] - ankle
    return np.asarray(bend + toes)


def _left_first(pair: _Pair, positions: FloatArray, left: FloatArray) -> _Pair | None:
    """The pair with its left chain first; None if the sides are not clear."""
    branching, one, other = pair
    apart = _limb_start(one, positions) - _limb_start(other, positions)
    evidence = np.sum(apart * left, axis=-1)
    possible = np.linalg.norm(apart, axis=-1) * np.linalg.norm(left, axis=-1)
    if abs(evidence.sum()) <= MIN_SIDE_EVIDENCE * possible.sum():
        return None
    return (branching, one, other) if evidence.sum() > 0 else (branching, other, one)


def _limb_start(chain: _Chain, positions: FloatArray) -> FloatArray:
    """(frames, 3) the start of the upper main bone, or its middle if the start is on the trunk."""
    first = chain.main_bones()
    joints = chain.joints[first : first + 1 if first else 2]
    return np.asarray(positions[:, list(joints)].mean(axis=1))


_LEG = ("upper_leg", "knee", "foot", "toes")
_ARM = ("shoulder", "elbow", "hand")


def _limb_roles(pair: _Pair, parts: tuple[str, ...]) -> dict[JointRole, int]:
    """The joints of the roles of a pair whose left chain comes first."""
    found = {}
    for side, chain in zip(("left", "right"), pair[1:], strict=True):
        main = chain.joints[chain.main_bones() :]
        for part, joint in zip(parts, main, strict=False):
            found[JointRole(f"{side}_{part}")] = joint
    return found
