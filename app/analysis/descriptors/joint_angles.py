"""The angles of the joints over time, as gait laboratories measure them (Vasilescu 2002, sec. 6).

The positions are smoothed (app.motion.skeleton.smoothing). Each limb gets a coordinate frame, and
its orientation relative to the limb before it gives the joint's angles. The angles are computed
from positions by role, not from the file's rotations. Some formats have no rotations, and rotations
depend on the rest pose of each skeleton, so they do not agree across libraries.

A ball joint has three angles that are smooth for all directions of a limb. Two are the swing of
the limb from a resting direction, as a vector along the sphere. The third is the turn of the limb
about its length, which shows in the direction to which the next joint bends. A straight limb does
not show it. Such frames count as missing and are filled by a cubic spline, as in the paper.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.motion.skeleton.occlusion import MAX_GAP, runs
from app.motion.skeleton.rotations import cross
from app.numerics.arrays import BoolArray, FloatArray

MIN_BEND = np.radians(12.0)
"""Radians. With a smaller bend of elbow or knee, the plane of the limb is noise."""

MIN_LIMB_LENGTH = 1e-3
"""Meters. A limb that is not longer has no direction, and its angles are 0."""

_TINY = 1e-9

_R = JointRole


@dataclass(frozen=True, slots=True)
class Ball:
    """A hip or shoulder: the limb goes from `start` to `middle`, and the next limb to `end`.

    rest: the direction of the limb whose swing is 0. hinge: the axis about which the next joint
    bends if the limb is at rest and its turn is 0. Both are unit vectors in the trunk's frame
    (left, up, forward).
    """

    name: str
    start: JointRole
    middle: JointRole
    end: JointRole
    rest: tuple[float, float, float]
    hinge: tuple[float, float, float]


_H, _Q, _S = np.sqrt(0.5), 0.5 * np.sqrt(0.5), np.sqrt(0.75)
BALLS = (
    Ball("left_hip", _R.HIPS, _R.LEFT_KNEE, _R.LEFT_FOOT, (0, -1, 0), (1, 0, 0)),
    Ball("right_hip", _R.HIPS, _R.RIGHT_KNEE, _R.RIGHT_FOOT, (0, -1, 0), (1, 0, 0)),
    # Arms hang, reach forward and go up, but never point behind the back to the other side.
    # If an arm is held forward, its elbow usually bends inward and up.
    Ball("left_arm", _R.LEFT_SHOULDER, _R.LEFT_ELBOW, _R.LEFT_HAND, (_H, 0, _H), (-_Q, -_S, _Q)),
    Ball(
        "right_arm", _R.RIGHT_SHOULDER, _R.RIGHT_ELBOW, _R.RIGHT_HAND, (-_H, 0, _H), (-_Q, _S, -_Q)
    ),
)

ANGLES: tuple[str, ...] = (
    "trunk_pitch",
    "trunk_roll",
    "head_pitch",
    "head_roll",
    *(f"{ball.name}_{angle}" for ball in BALLS for angle in ("flexion", "aside", "turn", "bend")),
)
"""The names of the 20 angles (radians), in their order."""

_UP, _LEFT = np.array([0.0, 1.0, 0.0]), np.array([1.0, 0.0, 0.0])
RESTS = np.array([ball.rest for ball in BALLS], dtype=np.float64)[:, None]
HINGES = np.array([ball.hinge for ball in BALLS], dtype=np.float64)[:, None]


def joint_angles(positions: FloatArray, rate: float) -> FloatArray:
    """(frames, 20) ANGLES, radians, of the 13 roles' positions (frames, 13, 3), meters, Y up.

    rate: frames per second. The angles are finite for all finite positions. They do not depend on
    the place, the heading or the size of the body.
    """
    points = np.asarray(positions, dtype=np.float64)
    trunk, heading = _trunk_frame(points), _heading_frame(points)
    spine = _in_frame(heading, _limb(points, (_R.HIPS,), (_R.NECK,)))
    head = _in_frame(trunk, _limb(points, (_R.NECK,), (_R.HEAD,)))
    starts, middles, ends = zip(*((b.start, b.middle, b.end) for b in BALLS), strict=True)
    upper = _in_frame(trunk, _limb(points, starts, middles))
    lower = _in_frame(trunk, _limb(points, middles, ends))
    balls = _ball_angles(upper, lower, max(1, round(MAX_GAP * rate)))
    swings = [_swing(limb, _UP, _LEFT)[0] for limb in (spine, head)]
    return np.hstack([*swings, *balls])


def with_gaps_filled(values: FloatArray, seen: BoolArray, max_gap: int) -> FloatArray:
    """`values` (frames,) with the frames that are not `seen` (frames,) filled from the others.

    Gaps of at most `max_gap` frames are filled by a cubic spline, longer ones by a straight line,
    because a spline would overshoot. Gaps at the ends get the nearest seen value. If nothing is
    seen, all values are 0.
    """
    at = np.flatnonzero(seen)
    if not len(at):
        return np.zeros(len(values))
    every = np.arange(len(values))
    filled = np.interp(every, at, values[at])
    short = [
        np.arange(start, stop)
        for start, stop in runs(~seen)
        if start > 0 and stop < len(values) and stop - start <= max_gap
    ]
    if short and len(at) >= 4:
        gaps = np.concatenate(short)
        filled[gaps] = scipy.interpolate.CubicSpline(at, values[at])(gaps)
    return np.asarray(filled)


def _ball_angles(upper: FloatArray, lower: FloatArray, max_gap: int) -> FloatArray:
    """(4, n, 4) for each of BALLS the flexion, aside and turn, and the bend of the next joint.

    upper, lower: (4, n, 3) the directions of both limbs in the trunk's frame.
    """
    axis = cross(upper, lower)
    sine, cosine = np.linalg.norm(axis, axis=-1), (upper * lower).sum(axis=-1)
    has_length = _has_direction(upper) & _has_direction(lower)
    hinges = rotated_with(HINGES, RESTS, upper)
    turns = np.arctan2((cross(hinges, axis) * upper).sum(axis=-1), (hinges * axis).sum(axis=-1))
    seen = has_length & (sine > np.sin(MIN_BEND))
    turns = np.stack([with_gaps_filled(*each, max_gap) for each in zip(turns, seen, strict=True)])
    bends = np.arctan2(sine, cosine) * has_length
    swings = _swing(upper, RESTS, HINGES)
    return np.concatenate([swings, turns[..., None], bends[..., None]], axis=-1)


def _swing(limbs: FloatArray, rest: FloatArray, about: FloatArray) -> FloatArray:
    """(k, n, 2) the path along the sphere from `rest` to the directions `limbs` (k, n, 3), radians.

    The first component is the turn about the axis `about`, which is orthogonal to `rest`. The
    second is the part toward that axis.
    """
    ahead = cross(about, rest)
    forward, aside = (limbs * ahead).sum(axis=-1), (limbs * about).sum(axis=-1)
    sine = np.hypot(forward, aside)
    angle = np.arctan2(sine, (limbs * rest).sum(axis=-1))
    scale = np.where(sine > _TINY, angle / np.maximum(sine, _TINY), 1.0) * _has_direction(limbs)
    return np.stack([forward * scale, aside * scale], axis=-1)


def rotated_with(vectors: FloatArray, starts: FloatArray, ends: FloatArray) -> FloatArray:
    """(k, n, 3) `vectors` (k, 1, 3) turned by the smallest rotations that bring `starts`
    (k, 1, 3) to `ends` (k, n, 3)."""
    axis = cross(starts, ends)
    cosine = (ends * starts).sum(axis=-1, keepdims=True)
    share = (axis * vectors).sum(axis=-1, keepdims=True) / np.maximum(1.0 + cosine, _TINY)
    return np.asarray(cosine * vectors + cross(axis, vectors) + share * axis)


def _limb(
    positions: FloatArray, starts: Sequence[JointRole], ends: Sequence[JointRole]
) -> FloatArray:
    """(k, n, 3) unit vectors from k joints to k others; 0 where both are at the same place."""
    first, last = ([SUN_ROLES.index(role) for role in roles] for roles in (starts, ends))
    line = np.moveaxis(positions[:, last] - positions[:, first], 1, 0)
    length = np.linalg.norm(line, axis=-1, keepdims=True)
    return np.asarray(
        np.where(length > MIN_LIMB_LENGTH, line / np.maximum(length, MIN_LIMB_LENGTH), 0.0)
    )


def _has_direction(limbs: FloatArray) -> BoolArray:
    return np.asarray(np.abs(limbs).max(axis=-1) > 0.0)


def _trunk_frame(positions: FloatArray) -> FloatArray:
    """(n, 3, 3) rows left, up, forward of the trunk: up along the spine."""
    return frame_of(_limb(positions, (_R.HIPS,), (_R.NECK,))[0], _left(positions))


def _heading_frame(positions: FloatArray) -> FloatArray:
    """(n, 3, 3) rows left, up, forward with up along the world's Y."""
    return frame_of(np.broadcast_to(_UP, (len(positions), 3)), _left(positions))


def _left(positions: FloatArray) -> FloatArray:
    """(n, 3) the shoulders' line; the knees' if there is no shoulder."""
    right, left = (_R.RIGHT_SHOULDER, _R.RIGHT_KNEE), (_R.LEFT_SHOULDER, _R.LEFT_KNEE)
    shoulders, knees = _limb(positions, right, left)
    return np.asarray(np.where(_has_direction(shoulders)[:, None], shoulders, knees))


def frame_of(up: FloatArray, left: FloatArray) -> FloatArray:
    """(n, 3, 3) rows left, up, forward: `up` (n, 3), and the part of `left` (n, 3) across it."""
    forward = _unit(cross(left, up), np.array([0.0, 0.0, 1.0]))
    return np.stack([_unit(cross(up, forward), _LEFT), up, forward], axis=1)


def _unit(vectors: FloatArray, otherwise: FloatArray) -> FloatArray:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.asarray(np.where(length > _TINY, vectors / np.maximum(length, _TINY), otherwise))


def _in_frame(frame: FloatArray, directions: FloatArray) -> FloatArray:
    """(k, n, 3) `directions` (k, n, 3) in the coordinates of `frame` (n, 3, 3)."""
    return np.asarray(np.einsum("nij,knj->kni", frame, directions))
