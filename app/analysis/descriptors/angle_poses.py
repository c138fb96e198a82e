"""Poses from joint angles: the inverse of `joint_angles`, on the canonical body.

Joint angles do not contain the size of the body, its heading or its place. So the poses have the
bone lengths of the canonical body (app.motion.posing.canonical_body), face Z, and have the hips at
the origin. Both shoulders are at right angles to the spine.
"""

from __future__ import annotations

import numpy as np

from app.analysis.descriptors.joint_angles import BALLS, HINGES, RESTS, frame_of, rotated_with
from app.motion.posing.canonical_body import BODY_ROLES, canonical_body
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.motion.skeleton.kinematics import rest_positions
from app.numerics.arrays import FloatArray

_UP, _LEFT = np.array([0.0, 1.0, 0.0]), np.array([1.0, 0.0, 0.0])
_R = JointRole
_MIN_LEVEL = 1e-9
_COLUMN = {role: column for column, role in enumerate(SUN_ROLES)}


def poses_of_angles(angles: FloatArray) -> FloatArray:
    """(n, 13, 3) positions in SUN_ROLES order, meters, Y up, of ANGLES (n, 20) in radians.

    `joint_angles` of the result are `angles`, if the swings are less than a half turn, the bends
    are from 0 to a half turn, and the spine is not level.
    """
    rows = np.asarray(angles, dtype=np.float64)
    rest = dict(zip(BODY_ROLES, rest_positions(canonical_body()), strict=True))
    spine = _swung(rows[:, :2], _UP, _LEFT)
    trunk = frame_of(spine, _shoulder_line(spine))
    positions = np.zeros((len(rows), len(SUN_ROLES), 3))
    positions[:, _COLUMN[_R.NECK]] = spine * _length(rest, _R.HIPS, _R.NECK)
    head = _in_world(trunk, _swung(rows[:, 2:4], _UP, _LEFT)) * _length(rest, _R.NECK, _R.HEAD)
    positions[:, _COLUMN[_R.HEAD]] = positions[:, _COLUMN[_R.NECK]] + head
    for role in (_R.LEFT_SHOULDER, _R.RIGHT_SHOULDER):
        # rows of `trunk` are left, up, forward, which are X, Y and Z of the rest pose
        positions[:, _COLUMN[role]] = _in_world(
            trunk, np.tile(rest[role] - rest[_R.HIPS], (len(rows), 1))
        )
    for place, ball in enumerate(BALLS):
        upper, lower = _limbs(rows[:, 4 * place + 4 : 4 * place + 8], RESTS[place], HINGES[place])
        start, middle, end = (_COLUMN[role] for role in (ball.start, ball.middle, ball.end))
        reach = _in_world(trunk, upper) * _length(rest, ball.start, ball.middle)
        positions[:, middle] = positions[:, start] + reach
        reach = _in_world(trunk, lower) * _length(rest, ball.middle, ball.end)
        positions[:, end] = positions[:, middle] + reach
    return positions


def _limbs(
    angles: FloatArray, rest: FloatArray, hinge: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """(n, 3) directions of a limb and of the next one, in the trunk's frame.

    angles: (n, 4) flexion, aside, turn and bend. rest, hinge: (1, 3), see `Ball`.
    """
    upper = _swung(angles[:, :2], rest[0], hinge[0])
    about = rotated_with(hinge[None], rest[None], upper[None])[0]
    turn, bend = angles[:, 2:3], angles[:, 3:4]
    axis = np.cos(turn) * about + np.sin(turn) * np.cross(upper, about)
    return upper, np.cos(bend) * upper + np.sin(bend) * np.cross(axis, upper)


def _swung(swings: FloatArray, rest: FloatArray, about: FloatArray) -> FloatArray:
    """(n, 3) the directions that are `swings` (n, 2) along the sphere from `rest` (3,)."""
    angle = np.linalg.norm(swings, axis=1, keepdims=True)
    toward = swings[:, :1] * np.cross(about, rest) + swings[:, 1:] * about
    return np.asarray(np.cos(angle) * rest + np.sinc(angle / np.pi) * toward)


def _shoulder_line(spine: FloatArray) -> FloatArray:
    """(n, 3) the line at right angles to `spine` (n, 3) whose level part points to the left."""
    side = np.where(spine[:, 1] < 0, -1.0, 1.0)
    line = np.stack([side * spine[:, 1], -side * spine[:, 0], np.zeros(len(spine))], axis=1)
    is_level = np.linalg.norm(line, axis=1, keepdims=True) < _MIN_LEVEL
    return np.asarray(np.where(is_level, _LEFT, line))


def _in_world(frame: FloatArray, vectors: FloatArray) -> FloatArray:
    """(n, 3) `vectors` (n, 3), given in the coordinates of `frame` (n, 3, 3), in the world."""
    return np.asarray(np.einsum("nij,ni->nj", frame, vectors))


def _length(rest: dict[JointRole, FloatArray], start: JointRole, end: JointRole) -> float:
    return float(np.linalg.norm(rest[end] - rest[start]))
