"""The orientation of body segments over time, as the angles need them.

A segment's frame is that of the International Society of Biomechanics (Wu et al. 2002 and 2005):
X points forward, Y points up (along a limb, from its far end to its near end), Z points to the
right of the body, on both sides.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.rotations import matrices_to_quaternions, multiply
from app.numerics.arrays import FloatArray

SHORTEST = 1e-9
"""A vector that is not longer has no direction, in any unit."""

_R = JointRole
LIMBS: dict[str, tuple[JointRole, JointRole]] = {
    f"{side}_{name}": (JointRole(f"{side}_{near}"), JointRole(f"{side}_{far}"))
    for side in ("left", "right")
    for name, near, far in (
        ("thigh", "upper_leg", "knee"),
        ("shank", "knee", "foot"),
        ("upper_arm", "shoulder", "elbow"),
        ("forearm", "elbow", "hand"),
    )
}
"""The near and the far joint of each limb segment."""


class Neutral(StrEnum):
    """Where the neutral pose comes from, in which all angles are zero except those of limbs that
    are bent in it."""

    REST_POSE = "rest_pose"
    """The file has rotations, and its rest pose is a person who stands, as a T-pose."""

    UPRIGHT_POSE = "upright_pose"
    """The file has rotations, but its rest pose is no standing person. Neutral is the most
    upright frame of the clip, and knees and elbows bend about the axes that the motion shows."""

    POSITIONS = "positions"
    """The file has no rotations. Only angles that positions determine are there."""


@dataclass(frozen=True, slots=True)
class SegmentFrames:
    """The segments' orientations over n frames.

    turns: (n, 4) quaternions from a segment's frame to the world, by segment. axes: (n, 3) unit
    vectors along Y of limbs of which only the direction is known. neutral: where the neutral pose
    comes from.
    """

    neutral: Neutral
    turns: dict[str, FloatArray] = field(default_factory=dict)
    axes: dict[str, FloatArray] = field(default_factory=dict)


def unit(vectors: FloatArray) -> FloatArray:
    """Unit vectors (..., 3); NaN where a vector has no length."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(np.where(length > SHORTEST, vectors / np.maximum(length, SHORTEST), np.nan))


def turn_of_axes(up: FloatArray, right: FloatArray) -> FloatArray:
    """(..., 4) the turns of frames with Y along `up` (..., 3) and Z near `right` (..., 3).

    They are NaN where the two do not determine a frame.
    """
    y = unit(up)
    x = unit(np.cross(y, right))
    matrices = np.stack([x, y, np.cross(x, y)], axis=-1)
    known = np.isfinite(matrices).all(axis=(-2, -1))
    turns = matrices_to_quaternions(np.where(known[..., None, None], matrices, np.eye(3)))
    return np.asarray(np.where(known[..., None], turns, np.nan))


def shortest_turn(start: FloatArray, end: FloatArray) -> FloatArray:
    """(4,) the shortest turn from the direction `start` (3,) to the direction `end` (3,).

    Opposite directions turn about X.
    """
    a, b = unit(start), unit(end)
    half = np.concatenate([[1.0 + a @ b], np.cross(a, b)])
    if np.linalg.norm(half) < 1e-6:
        return np.array([0.0, 1.0, 0.0, 0.0])
    return np.asarray(half / np.linalg.norm(half))


def limb_turn(body: FloatArray, along: FloatArray) -> FloatArray:
    """(4,) the frame of a limb that was brought from hanging down to the direction `along` (3,)
    by the shortest turn.

    body: (4,) the frame of the body. So arms at the sides of a T-pose are abducted by 90 degrees,
    and neither flexed nor rotated.
    """
    down = -_up_of(body)
    return multiply(shortest_turn(down, along), body)


def _up_of(turn: FloatArray) -> FloatArray:
    w, x, y, z = turn
    return np.array([2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)])
