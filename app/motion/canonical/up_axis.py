"""Finds the axis that points up, and turns it to Y.

The axis along which the head is above the feet during the motion is up. If the file declares
another axis, the rest pose decides, because people also lie down: if it agrees with the file, the
axis of the file is up.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from app.motion.roles.joint_roles import JointRole
from app.numerics.arrays import FloatArray

MIN_HEIGHT_RATIO = 2.0
"""The height of the head above the feet along another axis must be larger, by this factor, than
their distance along the declared axis."""

_TO_Y_UP: dict[str, list[list[int]]] = {
    "x": [[0, -1, 0], [1, 0, 0], [0, 0, 1]],
    "y": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
    "z": [[1, 0, 0], [0, 0, 1], [0, -1, 0]],
    "-x": [[0, 1, 0], [-1, 0, 0], [0, 0, 1]],
    "-y": [[1, 0, 0], [0, -1, 0], [0, 0, -1]],
    "-z": [[1, 0, 0], [0, 0, -1], [0, 1, 0]],
}
"""The rotation that brings each axis to Y. None is a mirror, so a right-handed body stays so."""


def judge_up_axis(
    positions: FloatArray,
    rest: FloatArray,
    roles: Mapping[JointRole, int],
    declared: str,
) -> str:
    """The axis that points up: "x", "y", "z" or one of them with a minus sign.

    positions: (frames, joints, 3) in any unit. rest: (joints, 3) the positions if all rotations are
    0. roles: the joint of each role. declared: the axis that the file declares.
    """
    upright = _head_over_feet(positions, roles).mean(axis=0)
    moving = _axis(upright)
    along_declared = abs(float(upright["xyz".index(declared[-1])]))
    if moving in (declared, None) or np.abs(upright).max() < MIN_HEIGHT_RATIO * along_declared:
        return moving if moving and moving[-1] == declared[-1] else declared
    resting = _axis(_head_over_feet(rest[None], roles)[0])
    return declared if resting == declared or moving is None else moving


def to_y_up(positions: FloatArray, up_axis: str) -> FloatArray:
    """(..., 3) `positions` (..., 3), turned so that `up_axis` becomes Y. The unit stays."""
    if up_axis == "y":
        return positions
    turn = np.array(_TO_Y_UP[up_axis], dtype=positions.dtype)
    return np.asarray(positions @ turn.T)


def _head_over_feet(positions: FloatArray, roles: Mapping[JointRole, int]) -> FloatArray:
    """(frames, 3) the vector from the middle of the feet (or knees) to the head (or neck)."""
    top = roles.get(JointRole.HEAD, roles.get(JointRole.NECK))
    pairs = (
        (JointRole.LEFT_FOOT, JointRole.RIGHT_FOOT),
        (JointRole.LEFT_KNEE, JointRole.RIGHT_KNEE),
    )
    low = next(([roles[a], roles[b]] for a, b in pairs if a in roles and b in roles), None)
    if top is None or low is None:
        return np.zeros((len(positions), 3))
    return np.asarray(positions[:, top] - positions[:, low].mean(axis=1))


def _axis(direction: FloatArray) -> str | None:
    """The signed axis nearest to `direction` (3,); None for a zero vector."""
    if not np.any(direction):
        return None
    index = int(np.argmax(np.abs(direction)))
    return ("-" if direction[index] < 0 else "") + "xyz"[index]
