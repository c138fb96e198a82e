"""The canonical body in poses of known joint angles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.motion.motion import Motion
from app.motion.posing.canonical_body import BODY_ROLES, canonical_body
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.motion.skeleton.animation import Animation
from app.motion.skeleton.kinematics import local_translations
from app.motion.skeleton.rotations import (
    conjugate,
    euler_to_quaternions,
    identity_quaternions,
    matrices_to_quaternions,
    multiply,
    rotate,
)
from app.numerics.arrays import FloatArray

ROLES = {role: joint for joint, role in enumerate(BODY_ROLES)}
BODY = matrices_to_quaternions(np.array([[0.0, 0, -1], [0, 1, 0], [1, 0, 0]]))
"""The frame of the body at rest, which faces +Z: X forward, Y up, Z to the right."""
RATE = 50.0


def body(frames: int, turns: dict[JointRole, FloatArray]) -> Animation:
    """The body with some joints turned by (frames, 4) quaternions in the axes of the body:
    X forward, Y up, Z to the right."""
    skeleton = canonical_body()
    rotations = identity_quaternions((frames, len(skeleton)))
    for role, turn in turns.items():
        rotations[:, ROLES[role]] = multiply(multiply(BODY, turn), conjugate(BODY))
    hips = np.tile(skeleton.offsets[0], (frames, 1))
    return Animation(skeleton, rotations, local_translations(skeleton, hips), RATE)


def cardan(z: FloatArray, x: FloatArray, y: FloatArray) -> FloatArray:
    """(frames, 4) turns by degrees about Z, the turned X and the twice turned Y."""
    return euler_to_quaternions(np.radians(np.stack([z, x, y], axis=-1)), "ZXY")


def motion_of(animation: Animation) -> Motion:
    skeleton = animation.skeleton
    return Motion(
        format="bvh",
        names=skeleton.names,
        parents=skeleton.parents,
        positions=animation.positions().astype(np.float32),
        roles=ROLES,
        missing_roles=tuple(role for role in SUN_ROLES if role not in ROLES),
        frame_rate=animation.frame_rate,
        declared_frame_rate=animation.frame_rate,
        metres_per_unit=1.0,
    )


def with_other_axes(animation: Animation, axes: FloatArray) -> Animation:
    """The same movement from a file whose joints have other axes, so that its rest pose is no
    person. axes: (joints, 4), what turns the old axes of a joint to the new ones."""
    parents = animation.skeleton.parents
    above = np.where(
        parents[:, None] >= 0, axes[np.maximum(parents, 0)], identity_quaternions((len(parents),))
    )
    back = conjugate(above)
    return Animation(
        replace(animation.skeleton, offsets=rotate(back, animation.skeleton.offsets)),
        multiply(multiply(back, animation.rotations), axes),
        rotate(back, animation.translations),
        animation.frame_rate,
    )
