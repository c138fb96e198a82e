"""Represents a motion as rotations and translations of joints, as animation programs do.

The rotations are computed from positions, or come from a file. In both cases the translations are
chosen so that the joints have the given positions.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.deadline import check
from app.motion.skeleton.kinematics import forward_kinematics, joints_by_depth
from app.motion.skeleton.resampling import resample
from app.motion.skeleton.rotations import (
    conjugate,
    identity_quaternions,
    matrices_to_quaternions,
    multiply,
    rotate,
)
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import BoolArray, FloatArray, IntArray

MAX_STILL_DISTANCE = 2e-6
"""Meters. A joint moves if its translation differs from its offset by more than this. Errors add up
along a chain: with thirty joints, they are at most 0.06 mm."""
PARENT_WEIGHT = 3e-7
"""The weight of following the rotation of the parent, relative to that of the directions of bones.
It only decides what the directions do not determine, for example the twist about a single bone."""
MIN_HALF = 1e-7
"""The length of the half-angle quaternion below which a bone counts as reversed."""
BLOCK_FRAMES = 2048
"""Frames that are solved at once. This limits the memory."""


@dataclass(frozen=True, slots=True)
class Animation:
    """The rotations and translations of joints in the frames of their parents; meters, Y up.

    skeleton: the joints at rest. rotations: (frames, joints, 4) local unit quaternions w x y z.
    translations: (frames, joints, 3) local; they replace the skeleton's offsets. frame_rate: Hz.
    """

    skeleton: Skeleton
    rotations: FloatArray
    translations: FloatArray
    frame_rate: float

    def positions(self) -> FloatArray:
        """(frames, joints, 3) the world positions, in meters."""
        return forward_kinematics(self.skeleton, self.rotations, self.translations)

    def moving_joints(self) -> BoolArray:
        """(joints,) whether a joint is a root or its translation differs from its offset."""
        away = np.abs(self.translations - self.skeleton.offsets).max(axis=(0, 2))
        return np.asarray((away > MAX_STILL_DISTANCE) | (self.skeleton.parents < 0))

    def resampled(self, frame_rate: float) -> Animation:
        """The same movement at `frame_rate` Hz. Rotations are interpolated by the shorter way."""
        if frame_rate == self.frame_rate:
            return self
        turns = resample(continuous(self.rotations), self.frame_rate, frame_rate)
        lengths = np.linalg.norm(turns, axis=-1, keepdims=True)
        return replace(
            self,
            rotations=turns / np.maximum(lengths, 1e-9),
            translations=resample(self.translations, self.frame_rate, frame_rate),
            frame_rate=frame_rate,
        )


def continuous(rotations: FloatArray) -> FloatArray:
    """(frames, joints, 4) the same rotations, with signs by which quaternions do not jump.

    q and -q are the same rotation, but numbers between them are not.
    """
    turned_over = np.sum(rotations[1:] * rotations[:-1], axis=-1) < 0
    flips = np.cumsum(turned_over, axis=0) % 2 == 1
    result = np.array(rotations)
    result[1:][flips] *= -1
    return result


def animation_of_rotations(
    skeleton: Skeleton, rotations: FloatArray, positions: FloatArray, frame_rate: float
) -> Animation:
    """An animation with these rotations, whose joints have the given positions.

    rotations: (frames, joints, 4) local. positions: (frames, joints, 3) in the world. frame_rate:
    Hz. The translations follow from both.
    """
    world = np.array(rotations, dtype=np.float64)
    translations = positions.astype(np.float64)
    for joints in joints_by_depth(skeleton.parents)[1:]:
        check()
        parents = skeleton.parents[joints]
        world[:, joints] = multiply(world[:, parents], world[:, joints])
        bones = positions[:, joints].astype(np.float64) - positions[:, parents]
        translations[:, joints] = rotate(conjugate(world[:, parents]), bones)
    return Animation(skeleton, rotations, translations, frame_rate)


def animation_of_positions(
    names: Sequence[str], parents: IntArray, positions: FloatArray, frame_rate: float
) -> Animation:
    """An animation whose joints turn so that the bones have the directions in the positions.

    names, parents: (joints,). positions: (frames, joints, 3) in the world, meters. frame_rate:
    Hz. The rest pose has the directions of the first frame and the median lengths of bones. A joint
    turns so that the directions of its bones are as in the positions (least squares). If they do
    not determine its turn, and for joints without children, it follows its parent.
    """
    first = positions[0].astype(np.float64)
    offsets = first - np.where(parents[:, None] >= 0, first[parents], 0.0)
    lengths = bone_lengths(parents, positions)
    rest_lengths = np.linalg.norm(offsets, axis=-1)
    scale = np.where(parents >= 0, lengths / np.maximum(rest_lengths, 1e-9), 1.0)
    skeleton = Skeleton(tuple(names), parents, offsets * scale[:, None])
    bones = positions.astype(np.float64) - np.where(
        parents[:, None] >= 0, positions[:, parents].astype(np.float64), 0.0
    )
    rotations = solve_rotations(skeleton, bones)
    return animation_of_rotations(skeleton, rotations, positions, frame_rate)


def bone_lengths(parents: IntArray, positions: FloatArray) -> FloatArray:
    """(joints,) the median distance of each joint from its parent, in the unit of `positions`.

    positions: (frames, joints, 3). The length of a root is 0.
    """
    above = positions[:, np.maximum(parents, 0)]
    return np.asarray(np.median(np.linalg.norm(positions - above, axis=-1), axis=0), np.float64)


def solve_rotations(skeleton: Skeleton, bones: FloatArray) -> FloatArray:
    """(frames, joints, 4) the local rotations that turn the skeleton's bones along `bones`.

    bones: (frames, joints, 3) the world vectors from parents to joints; zero vectors are ignored.
    For each joint, Wahba's problem over its children is solved by the SVD (Markley 1988). Longer
    bones have larger weights. PARENT_WEIGHT is the weight of following the parent.
    """
    blocks = range(0, len(bones), BLOCK_FRAMES)
    return np.concatenate(
        [_solve_block(skeleton, bones[start : start + BLOCK_FRAMES]) for start in blocks]
    )


def _solve_block(skeleton: Skeleton, bones: FloatArray) -> FloatArray:
    frames, joints = bones.shape[:2]
    world = identity_quaternions((frames, joints))
    local = identity_quaternions((frames, joints))
    for joint in range(joints):
        check()
        parent = int(skeleton.parents[joint])
        above = world[:, parent] if parent >= 0 else identity_quaternions((frames,))
        children = skeleton.children(joint)
        if children:
            # seen (frames, children, 3): the bones in the frame of the parent
            seen = rotate(conjugate(above)[:, None], bones[:, children])
            rest = skeleton.offsets[children]
            turn = _swing(seen[:, 0], rest[0]) if len(children) == 1 else _wahba(seen, rest)
            local[:, joint] = turn
        world[:, joint] = multiply(above, local[:, joint])
    return local


def _swing(seen: FloatArray, rest: FloatArray) -> FloatArray:
    """(frames, 4) the shortest turns that bring `rest` (3,) to the directions `seen` (frames, 3).

    `_wahba` gives the same turns for a single bone, but is slower. A vector without length gives no
    turn. A reversed bone gives half a turn about any orthogonal axis.
    """
    to, start = _unit(seen), _unit(rest)
    across = np.cross(start, np.eye(3)[np.argmin(np.abs(start))])
    half = np.concatenate([1 + to @ start[:, None], np.cross(start, to)], axis=-1)
    length = np.linalg.norm(half, axis=-1, keepdims=True)
    reversed_turn = np.concatenate([[0.0], _unit(across)])
    return np.asarray(
        np.where(length > MIN_HALF, half / np.maximum(length, MIN_HALF), reversed_turn)
    )


def _wahba(seen: FloatArray, rest: FloatArray) -> FloatArray:
    """(frames, 4) the turns that bring `rest` (children, 3) nearest to `seen` (frames, children,
    3).

    If the vectors do not determine a turn, it is near the identity.
    """
    weights = np.linalg.norm(rest, axis=-1) * np.linalg.norm(seen, axis=-1)
    directions = _unit(seen) * weights[..., None]
    pull = PARENT_WEIGHT * np.maximum(weights.sum(axis=-1), 1e-9)[:, None, None] * np.eye(3)
    profile = np.einsum("fci,cj->fij", directions, _unit(rest)) + pull
    u, _, vt = np.linalg.svd(profile)
    # The sign makes the result a rotation, and not a mirror.
    u[..., 2] *= np.linalg.det(u @ vt)[:, None]
    return matrices_to_quaternions(u @ vt)


def _unit(vectors: FloatArray) -> FloatArray:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-12))
