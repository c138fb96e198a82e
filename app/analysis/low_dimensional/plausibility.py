"""Poses that no body takes (Perera 2009, figs 13 and 14): a joint beyond its range, a hand
inside the trunk.

Joint positions alone leave a limb's turn about its own length open. So only what is certain
is called implausible, with limits that recorded people keep (chosen on half of the real clips;
`tests/bench/test_low_dimensional.py` counts how many frames of the other half pass them):

- a knee folded beyond what thigh and calf leave room for, or bent forward;
- an elbow folded beyond that, or bent backward: its forearm within 60 degrees of straight
  away from where it would bend if the upper arm were swung there by the shortest way from
  hanging. An arm raised above the shoulder can turn so far that nothing is said of it;
- a head turned away from the line of the trunk beyond the neck's range;
- a hand within the trunk: near the line from hips to neck, its ends left out, since hands
  are laid on neck and hips.

Front, left and up are the trunk's own, so that who lies or stands on hands is judged alike.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import BoolArray, FloatArray

FOLDED_LIMIT = 160.0
"""Degrees between the directions of a limb's two bones."""
KNEE_BACKWARD_LIMIT = 10.0
"""Degrees that a knee is bent forward, as lax joints are."""
ELBOW_BACKWARD_LIMIT = 25.0
"""Degrees that an elbow is bent backward."""
BACKWARD_CONE = np.cos(np.radians(60.0))
RAISED = np.cos(np.radians(120.0))
"""Of the angle of an upper arm from hanging, beyond which elbows are not judged."""
HEAD_LIMIT = 70.0
"""Degrees between the neck and the line of the trunk."""
TRUNK_RADIUS = 0.07
"""Body lengths (7 cm of a person of 1.7 m) around the line from hips to neck."""
TRUNK_ENDS = 0.15
"""Share of the line from hips to neck that is left out at each end."""

_R = JointRole
_SMALLEST = 1e-9


class Fault(StrEnum):
    """What a body does not do."""

    FOLDED = "folded"
    """A knee or elbow is folded beyond its range."""
    BENT_BACKWARD = "bent_backward"
    """A knee or elbow is bent to the wrong side."""
    TURNED_AWAY = "turned_away"
    """The head leaves the neck's range."""
    IN_TRUNK = "in_trunk"
    """A hand is inside the trunk."""


@dataclass(frozen=True, slots=True)
class Implausible:
    """Frames first..last in which a joint is at fault without a break, the worst of them, and
    by how much that one passes the limit: degrees, or body lengths for IN_TRUNK."""

    fault: Fault
    joint: JointRole
    first: int
    last: int
    worst: int
    beyond: float


@dataclass(frozen=True, slots=True)
class Plausibility:
    """What was found in n frames: the runs of faults by time, and (n,) whether a frame has any."""

    faults: tuple[Implausible, ...]
    implausible: BoolArray

    @property
    def count(self) -> int:
        """Frames with a fault."""
        return int(self.implausible.sum())


def judge_poses(poses: FloatArray) -> Plausibility:
    """Judge poses (n, 13, 3) in SUN_ROLES order, in body lengths, Y up, as `BodyTrack.local`."""
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
    """Poses with the trunk's own axes, (n, 3) unit vectors."""

    def __init__(self, poses: FloatArray) -> None:
        self._poses = poses
        self.up = _unit(self.bone(_R.HIPS, _R.NECK))
        across = self.bone(_R.RIGHT_SHOULDER, _R.LEFT_SHOULDER)
        self.left = _unit(across - _along(across, self.up))
        self.front = np.cross(self.left, self.up)

    def bone(self, start: JointRole, end: JointRole) -> FloatArray:
        """(n, 3) from one joint to another."""
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
        # A knee that bends as knees do turns the shank about the body's left.
        side = np.sum(_unit(np.cross(thigh, shank)) * body.left, axis=-1)
        return np.asarray(-side * _angle(thigh, shank) - KNEE_BACKWARD_LIMIT)

    return check


def _elbow_backward(limb: _Limb) -> _Check:
    upper, middle, end = limb

    def check(body: _Body) -> FloatArray:
        arm, forearm = _unit(body.bone(upper, middle)), body.bone(middle, end)
        usual, hanging = _swung_front(body, arm)
        bend = _unit(forearm - _along(forearm, arm))
        backward = -np.sum(bend * usual, axis=-1)
        judged = (backward > BACKWARD_CONE) & (hanging > RAISED)
        return np.where(judged, _angle(arm, forearm), 0.0) - ELBOW_BACKWARD_LIMIT

    return check


def _turned_away(body: _Body) -> FloatArray:
    return _angle(body.up, body.bone(_R.NECK, _R.HEAD)) - HEAD_LIMIT


def _in_trunk(hand: JointRole) -> _Check:
    def check(body: _Body) -> FloatArray:
        trunk, arm = body.bone(_R.HIPS, _R.NECK), body.bone(_R.HIPS, hand)
        length = np.maximum(np.sum(trunk * trunk, axis=-1), _SMALLEST)
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
    """The unbroken runs of frames in which `beyond` (n,) is above 0."""
    edges = np.diff((beyond > 0).astype(np.int8), prepend=0, append=0)
    found = []
    for first, stop in zip(np.flatnonzero(edges > 0), np.flatnonzero(edges < 0), strict=True):
        worst = int(first + np.argmax(beyond[first:stop]))
        found.append(
            Implausible(fault, joint, int(first), int(stop) - 1, worst, float(beyond[worst]))
        )
    return found


def _swung_front(body: _Body, arm: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The trunk's front (n, 3) after the shortest turn from hanging to `arm` (n, 3, unit),
    and (n,) the cosine of that turn."""
    down = -body.up
    cos = np.sum(down * arm, axis=-1)
    axis = np.cross(down, arm)
    once = np.cross(axis, body.front)
    twice = np.cross(axis, once) / np.maximum(1 + cos, _SMALLEST)[:, None]
    return body.front + once + twice, cos


def _angle(one: FloatArray, other: FloatArray) -> FloatArray:
    """(n,) degrees between vectors; 0 where either has no length."""
    across = np.linalg.norm(np.cross(one, other), axis=-1)
    return np.asarray(np.degrees(np.arctan2(across, np.sum(one * other, axis=-1))))


def _along(vectors: FloatArray, units: FloatArray) -> FloatArray:
    return np.asarray(np.sum(vectors * units, axis=-1, keepdims=True) * units)


def _unit(vectors: FloatArray) -> FloatArray:
    """Unit vectors; 0 stays 0."""
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(vectors / np.maximum(lengths, _SMALLEST))
