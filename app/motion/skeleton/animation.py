"""A motion as rotations and translations of joints: what animation programs play.

Solved from positions alone, or made of the rotations that a file had. Either way the
translations are such that the joints stand where the positions say.
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

STILL = 2e-6
"""Meters: a joint that leaves its offset by no more is not said to move along its bone.
Errors add up along a chain; thirty joints stay within 0.06 mm."""
FOLLOW_PARENT = 3e-7
"""Weight of turning with the parent against the bones' directions: so little that it decides
only what they leave open, such as the twist about a single one."""
REVERSED = 1e-7
"""Sine of half the angle that a bone is short of being reversed."""
BLOCK_FRAMES = 2048
"""Frames that are solved at once, so that matrices stay small."""


@dataclass(frozen=True, slots=True)
class Animation:
    """Joints turning and moving in their parents' frames, meters, Y up.

    skeleton: at rest; rotations: (frames, joints, 4) unit quaternions w x y z, local;
    translations: (frames, joints, 3) local, which replace the skeleton's offsets;
    frame_rate: Hz.
    """

    skeleton: Skeleton
    rotations: FloatArray
    translations: FloatArray
    frame_rate: float

    def positions(self) -> FloatArray:
        """(frames, joints, 3) world positions, meters."""
        return forward_kinematics(self.skeleton, self.rotations, self.translations)

    def moving_joints(self) -> BoolArray:
        """(joints,): roots, and joints whose translation leaves their offset."""
        away = np.abs(self.translations - self.skeleton.offsets).max(axis=(0, 2))
        return np.asarray((away > STILL) | (self.skeleton.parents < 0))

    def resampled(self, frame_rate: float) -> Animation:
        """The same movement at another rate; rotations along the shorter way."""
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
    """The same rotations (frames, joints, 4), each quaternion on the side of the one before."""
    turned_over = np.sum(rotations[1:] * rotations[:-1], axis=-1) < 0
    flips = np.cumsum(turned_over, axis=0) % 2 == 1
    result = np.array(rotations)
    result[1:][flips] *= -1
    return result


def animation_of_rotations(
    skeleton: Skeleton, rotations: FloatArray, positions: FloatArray, frame_rate: float
) -> Animation:
    """Rotations (frames, joints, 4) with the translations that lead to positions
    (frames, joints, 3); where the skeleton's offsets do so they stay exactly."""
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
    """Joints (frames, joints, 3) in meters, turned so that bones follow their directions.

    The rest pose is the first frame. A joint turns as its children do (least squares); one
    without children turns with its parent; what bones leave open follows the parent.
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
    """(joints,) median distance of each joint from its parent."""
    above = positions[:, np.maximum(parents, 0)]
    return np.asarray(np.median(np.linalg.norm(positions - above, axis=-1), axis=0), np.float64)


def solve_rotations(skeleton: Skeleton, bones: FloatArray) -> FloatArray:
    """Local rotations (frames, joints, 4) that turn the skeleton's bones along `bones`.

    bones: (frames, joints, 3) world vector from parent to joint; a zero vector says
    nothing. Each joint solves Wahba's problem over its children by the SVD (Markley 1988),
    long bones weighing more, with a light pull toward its parent's turn.
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
            # seen from the parent's frame: (frames, children, 3)
            seen = rotate(conjugate(above)[:, None], bones[:, children])
            rest = skeleton.offsets[children]
            turn = _swing(seen[:, 0], rest[0]) if len(children) == 1 else _wahba(seen, rest)
            local[:, joint] = turn
        world[:, joint] = multiply(above, local[:, joint])
    return local


def _swing(seen: FloatArray, rest: FloatArray) -> FloatArray:
    """(frames, 4): the shortest turns that bring rest (3,) along seen (frames, 3).

    What `_wahba` comes to for a single bone; no turn where either has no length, and half
    a turn about some axis across where the bone is reversed.
    """
    to, start = _unit(seen), _unit(rest)
    across = np.cross(start, np.eye(3)[np.argmin(np.abs(start))])
    half = np.concatenate([1 + to @ start[:, None], np.cross(start, to)], axis=-1)
    length = np.linalg.norm(half, axis=-1, keepdims=True)
    reversed_turn = np.concatenate([[0.0], _unit(across)])
    return np.asarray(
        np.where(length > REVERSED, half / np.maximum(length, REVERSED), reversed_turn)
    )


def _wahba(seen: FloatArray, rest: FloatArray) -> FloatArray:
    """(frames, 4): turns that bring rest (children, 3) nearest to seen (frames, children, 3),
    near the identity where these leave it open."""
    weights = np.linalg.norm(rest, axis=-1) * np.linalg.norm(seen, axis=-1)
    directions = _unit(seen) * weights[..., None]
    pull = FOLLOW_PARENT * np.maximum(weights.sum(axis=-1), 1e-9)[:, None, None] * np.eye(3)
    profile = np.einsum("fci,cj->fij", directions, _unit(rest)) + pull
    u, _, vt = np.linalg.svd(profile)
    u[..., 2] *= np.linalg.det(u @ vt)[:, None]
    return matrices_to_quaternions(u @ vt)


def _unit(vectors: FloatArray) -> FloatArray:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-12))
