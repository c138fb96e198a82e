"""Finds poses that no body can take (Perera 2009, figs 13 and 14).

Joint positions do not show the turn of a limb about its own length. So a pose is implausible only
if it is certainly impossible. The limits were chosen on half of the real clips, so that recorded
people stay within them; `tests/bench/test_low_dimensional.py` counts the frames of the other half
that exceed them. The faults are:

- a knee that is bent more than thigh and calf allow, or bent forward;
- an elbow that is bent more than the arm allows, or bent backward: its forearm is within 60 degrees
  of the direction opposite to its usual bend. The usual bend is that of an arm which swung from
  hanging to its position by the shortest path. An arm that is raised above the shoulder can turn
  too far to be judged;
- a head that is turned away from the line of the trunk beyond the range of the neck;
- a hand inside the trunk: near the line from hips to neck. The ends of this line do not count,
  because people put their hands on neck and hips.

Front, left and up are axes of the trunk, so the judgment of a person who lies is the same.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import BoolArray, FloatArray

FOLDED_LIMIT = 160.0
"""Degrees: the largest angle between the directions of the two bones of a limb."""
KNEE_BACKWARD_LIMIT = 10.0
"""Degrees by which flexible knees may bend forward."""
ELBOW_BACKWARD_LIMIT = 25.0
"""Degrees by which flexible elbows may bend backward."""
BACKWARD_COSINE = np.cos(np.radians(60.0))
"""The cosine of the largest angle between the bend of an elbow and the backward direction."""
RAISED_COSINE = np.cos(np.radians(120.0))
"""The cosine of the angle of an upper arm from hanging above which elbows are not judged."""
HEAD_LIMIT = 70.0
"""Degrees: the largest angle between the neck and the line of the trunk."""
TRUNK_RADIUS = 0.07
"""Body lengths (7 cm of a person of 1.7 m) around the line from hips to neck."""
TRUNK_ENDS = 0.15
"""The share of the line from hips to neck that does not count at each end."""

_R = JointRole
_MIN_LENGTH = 1e-9


class Fault(StrEnum):
    """The kinds of impossible poses."""

    FOLDED = "folded"
    """A knee or elbow is folded beyond its range."""
    BENT_BACKWARD = "bent_backward"
    """A knee or elbow is bent to the wrong side."""
    TURNED_AWAY = "turned_away"
    """The head is turned beyond the range of the neck."""
    IN_TRUNK = "in_trunk"
    """A hand is inside the trunk."""


@dataclass(frozen=True, slots=True)
class Implausible:
    """A run of frames, first to last, in which a joint has a fault.

    worst: the frame with the largest fault. beyond: how far this frame exceeds the limit, in
    degrees, or in body lengths for IN_TRUNK.
    """

    fault: Fault
    joint: JointRole
    first: int
    last: int
    worst: int
    beyond: float


@dataclass(frozen=True, slots=True)
class Plausibility:
    """The faults of n frames.

    faults: the runs, in order of time. implausible: (n,) whether a frame has a fault.
    """

    faults: tuple[Implausible, ...]
    implausible: BoolArray

    @property
    def count(self) -> int:
        """The number of frames with a fault."""
        return int(self.implausible.sum())


def judge_poses(poses: FloatArray) -> Plausibility:
    """Find the faults of `poses` (n, 13, 3), in the body frame and in body lengths.

    The joints are in the order of SUN_ROLES, Y up, as in `BodyTrack.local`.
    """
    body = _Body(poses.astype(np.float64))
    found: list[Implausible] = []
    implausible = np.zeros(len(poses), dtype=bool)
    for fault, joint, check in _CHECKS:
        beyond = check(body)
        found += _runs(fault, joint, beyond)
        implausible |= beyond > 0
    found.sort(key=lambda run: (run.first, run.joint, run.fault))
    return Plausibility(tuple(found), implausible)


class _Body:
    """Poses, and the axes of the trunk: up, left and front, (n, 3) unit vectors."""

    def __init__(self, poses: FloatArray) -> None:
        self._poses = poses
        self.up = _unit(self.bone(_R.HIPS, _R.NECK))
        across = self.bone(_R.RIGHT_SHOULDER, _R.LEFT_SHOULDER)
        self.left = _unit(across - _along(across, self.up))
        self.front = np.cross(self.left, self.up)

    def bone(self, start: JointRole, end: JointRole) -> FloatArray:
        """(n, 3) the vectors from one joint to another."""
        column = SUN_ROLES.index
        return np.asarray(self._poses[:, column(end)] - self._poses[:, column(start)])


_Check = Callable[[_Body], FloatArray]
_Limb = tuple[JointRole, JointRole, JointRole]


def _folded(limb: _Limb) -> _Check:
    upper, middle, end = limb
    return lambda body: _angle(body.bone(upper, middle), body.bone(middle, end)) - FOLDED_LIMIT


def _knee_backward(limb: _Limb) -> _Check:
    upper, middle, end = limb

    def check(body: _Body) -> FloatArray:
        thigh, shank = body.bone(upper, middle), body.bone(middle, end)
        # the axis of a knee that bends in the bend_direction way points to the left
        side = np.sum(_unit(np.cross(thigh, shank)) * body.left, axis=-1)
        return np.asarray(-side * _angle(thigh, shank) - KNEE_BACKWARD_LIMIT)

    return check


def _elbow_backward(limb: _Limb) -> _Check:
    upper, middle, end = limb

    def check(body: _Body) -> FloatArray:
        arm, forearm = _unit(body.bone(upper, middle)), body.bone(middle, end)
        bend_direction, hanging = _usual_bend(body, arm)
        bend = _unit(forearm - _along(forearm, arm))
        backward = -np.sum(bend * bend_direction, axis=-1)
        judged = (backward > BACKWARD_COSINE) & (hanging > RAISED_COSINE)
        return np.where(judged, _angle(arm, forearm), 0.0) - ELBOW_BACKWARD_LIMIT

    return check


def _turned_away(body: _Body) -> FloatArray:
    return _angle(body.up, body.bone(_R.NECK, _R.HEAD)) - HEAD_LIMIT


def _in_trunk(hand: JointRole) -> _Check:
    def check(body: _Body) -> FloatArray:
        trunk, arm = body.bone(_R.HIPS, _R.NECK), body.bone(_R.HIPS, hand)
        length = np.maximum(np.sum(trunk * trunk, axis=-1), _MIN_LENGTH)
        share = np.clip(np.sum(arm * trunk, axis=-1) / length, TRUNK_ENDS, 1 - TRUNK_ENDS)
        return np.asarray(TRUNK_RADIUS - np.linalg.norm(arm - share[:, None] * trunk, axis=-1))

    return check


_LEGS: tuple[_Limb, ...] = (
    (_R.HIPS, _R.LEFT_KNEE, _R.LEFT_FOOT),
    (_R.HIPS, _R.RIGHT_KNEE, _R.RIGHT_FOOT),
)
_ARMS: tuple[_Limb, ...] = (
    (_R.LEFT_SHOULDER, _R.LEFT_ELBOW, _R.LEFT_HAND),
    (_R.RIGHT_SHOULDER, _R.RIGHT_ELBOW, _R.RIGHT_HAND),
)
_CHECKS: tuple[tuple[Fault, JointRole, _Check], ...] = (
    *((Fault.FOLDED, limb[1], _folded(limb)) for limb in (*_LEGS, *_ARMS)),
    *((Fault.BENT_BACKWARD, leg[1], _knee_backward(leg)) for leg in _LEGS),
    *((Fault.BENT_BACKWARD, arm[1], _elbow_backward(arm)) for arm in _ARMS),
    (Fault.TURNED_AWAY, _R.HEAD, _turned_away),
    *((Fault.IN_TRUNK, arm[2], _in_trunk(arm[2])) for arm in _ARMS),
)


def _runs(fault: Fault, joint: JointRole, beyond: FloatArray) -> list[Implausible]:
    """The runs of consecutive frames in which `beyond` (n,) is above 0."""
    edges = np.diff((beyond > 0).astype(np.int8), prepend=0, append=0)
    found = []
    for first, stop in zip(np.flatnonzero(edges > 0), np.flatnonzero(edges < 0), strict=True):
        worst = int(first + np.argmax(beyond[first:stop]))
        found.append(
            Implausible(fault, joint, int(first), int(stop) - 1, worst, float(beyond[worst]))
        )
    return found


def _usual_bend(body: _Body, arm: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(n, 3) the usual direction of an elbow's bend, and (n,) the cosine of the arm from hanging.

    arm: (n, 3) unit vectors. The direction is the front of the trunk after the shortest rotation
    from hanging to `arm` (Rodrigues' formula).
    """
    down = -body.up
    cos = np.sum(down * arm, axis=-1)
    axis = np.cross(down, arm)
    once = np.cross(axis, body.front)
    twice = np.cross(axis, once) / np.maximum(1 + cos, _MIN_LENGTH)[:, None]
    return body.front + once + twice, cos


def _angle(one: FloatArray, other: FloatArray) -> FloatArray:
    """(n,) the degrees between vectors (n, 3); 0 if one of them has no length."""
    across = np.linalg.norm(np.cross(one, other), axis=-1)
    return np.asarray(np.degrees(np.arctan2(across, np.sum(one * other, axis=-1))))


def _along(vectors: FloatArray, units: FloatArray) -> FloatArray:
    return np.asarray(np.sum(vectors * units, axis=-1, keepdims=True) * units)


def _unit(vectors: FloatArray) -> FloatArray:
    """(n, 3) unit vectors; a vector of length 0 stays 0."""
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(vectors / np.maximum(lengths, _MIN_LENGTH))
