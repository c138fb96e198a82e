"""Mirrors a motion: what the left side did, the right side does.

The mirror is the vertical plane through the hips of the first frame, along the body's heading
there, so the motion starts in the same place and faces the same way. With M the reflection of the
world and F that of an axis of the local frames, the rotation W of a root becomes M W F, the
rotation R of any other joint F R F, and its translation t becomes F t. So each joint reaches
exactly the mirrored position. F is the axis from side to side of the rest pose: then a skeleton
with equal sides stays as it is.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.motion.editing.edited import Edited
from app.motion.editing.mirrored_joints import mirrored_joints
from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.animation import Animation
from app.motion.skeleton.rotations import matrices_to_quaternions, quaternions_to_matrices
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray, IntArray


def mirror(edited: Edited) -> Edited:
    """The mirrored motion, with the same names of joints. Raises TooShort, NotHuman."""
    animation = edited.animation
    skeleton = animation.skeleton
    other = mirrored_joints(skeleton.names, edited.roles)
    axis = _axis_across(skeleton, other)
    reflected = _reflected(animation, axis, _left_at_start(edited), _start(edited))
    return edited.with_animation(_exchanged(reflected, other))


def _left_at_start(edited: Edited) -> FloatArray:
    """(3,) the horizontal direction to the left of the body in the first frame."""
    heading = edited.track().heading[0]
    return np.array([np.cos(heading), 0.0, -np.sin(heading)])


def _start(edited: Edited) -> FloatArray:
    """(3,) the place of the hips in the first frame."""
    place: FloatArray = edited.animation.positions()[0, edited.roles[JointRole.HIPS]]
    return place


def _axis_across(skeleton: Skeleton, other: IntArray) -> int:
    """The axis, 0 to 2, whose reflection brings the offsets of one side to those of the other."""
    errors = []
    for axis in range(3):
        flip = _flip(axis)
        difference = skeleton.offsets - flip * skeleton.offsets[other]
        errors.append(float(np.square(difference).sum()))
    return int(np.argmin(errors))


def _flip(axis: int) -> FloatArray:
    flip = np.ones(3)
    flip[axis] = -1.0
    return flip


def _reflected(animation: Animation, axis: int, left: FloatArray, place: FloatArray) -> Animation:
    """The animation behind the mirror; each joint is still on its own side."""
    skeleton, flip = animation.skeleton, _flip(axis)
    roots = skeleton.parents < 0
    # A rotation axis is a pseudovector: it turns over, apart from its component along `axis`.
    rotations = animation.rotations * np.array([1.0, *(-flip)])
    translations = animation.translations * flip
    plane = np.eye(3) - 2.0 * np.outer(left, left)
    world = quaternions_to_matrices(animation.rotations[:, roots])
    rotations[:, roots] = matrices_to_quaternions(plane @ world @ np.diag(flip))
    translations[:, roots] = (animation.translations[:, roots] - place) @ plane + place
    mirrored = replace(
        skeleton, offsets=skeleton.offsets * flip, end_offsets=skeleton.end_offsets * flip
    )
    return replace(animation, skeleton=mirrored, rotations=rotations, translations=translations)


def _exchanged(animation: Animation, other: IntArray) -> Animation:
    """The animation in which each joint has what its joint on the other side had.

    If both sides have the same tree, the joints stay in their order. Otherwise the names change
    their places.
    """
    skeleton = animation.skeleton
    above = skeleton.parents[other]
    if not np.array_equal(np.where(above < 0, -1, other[above]), skeleton.parents):
        names = tuple(skeleton.names[joint] for joint in other)
        return replace(animation, skeleton=replace(skeleton, names=names))
    exchanged = replace(
        skeleton, offsets=skeleton.offsets[other], end_parents=other[skeleton.end_parents]
    )
    return replace(
        animation,
        skeleton=exchanged,
        rotations=animation.rotations[:, other],
        translations=animation.translations[:, other],
    )
