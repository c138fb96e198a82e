"""The canonical body: the movement of any clip on one skeleton with fixed bone lengths.

The body has Sun's 13 roles and a few more. It is 1.7 m tall, and its segments are those of Drillis
and Contini (1966; Winter, "Biomechanics and motor control of human movement", fig. 4.1). Its rest
pose is a T-pose that faces Z, with left at +X. Its joints turn so that its bones have the
directions of the clip's bones. The path over the ground is scaled by the length of the legs. In
each frame, the lower foot has the height of that of the clip above the floor, scaled in the same
way. So standing feet stay on the floor. Roles that a clip does not have keep the T-pose relative
to their parent.
"""

from __future__ import annotations

import numpy as np

from app.motion.motion import Motion
from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.animation import Animation, solve_rotations
from app.motion.skeleton.kinematics import forward_kinematics, local_translations
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray

STATURE = 1.7
"""Meters."""
ANKLE_HEIGHT = 0.039 * STATURE
"""Meters: the height of the ankle above a flat sole (Winter)."""
FLOOR_PERCENTILE = 5.0
"""The percentile of the lower foot's heights that is the floor. A few frames may be lower."""
CHEST_SHARE = 0.6
"""The position of a missing chest on the line from hips (0) to neck (1)."""
MIN_LEG_LENGTH = 1e-3
"""Meters: the smallest leg length by which paths are scaled."""

_R = JointRole
# For each role: the role of its parent, and its offset in the rest pose as a share of the stature.
_BODY: dict[JointRole, tuple[JointRole | None, tuple[float, float, float]]] = {
    _R.HIPS: (None, (0, 0.569, 0)),
    _R.CHEST: (_R.HIPS, (0, 0.17, -0.01)),
    _R.NECK: (_R.CHEST, (0, 0.118, 0.005)),
    _R.HEAD: (_R.NECK, (0, 0.07, 0.015)),
    _R.LEFT_SHOULDER: (_R.CHEST, (0.11, 0.1, 0)),
    _R.LEFT_ELBOW: (_R.LEFT_SHOULDER, (0.186, 0, 0)),
    _R.LEFT_HAND: (_R.LEFT_ELBOW, (0.146, 0, 0)),
    _R.RIGHT_SHOULDER: (_R.CHEST, (-0.11, 0.1, 0)),
    _R.RIGHT_ELBOW: (_R.RIGHT_SHOULDER, (-0.186, 0, 0)),
    _R.RIGHT_HAND: (_R.RIGHT_ELBOW, (-0.146, 0, 0)),
    _R.LEFT_UPPER_LEG: (_R.HIPS, (0.055, -0.039, 0)),
    _R.LEFT_KNEE: (_R.LEFT_UPPER_LEG, (0, -0.245, 0)),
    _R.LEFT_FOOT: (_R.LEFT_KNEE, (0, -0.246, 0)),
    _R.LEFT_TOES: (_R.LEFT_FOOT, (0, -0.03, 0.08)),
    _R.RIGHT_UPPER_LEG: (_R.HIPS, (-0.055, -0.039, 0)),
    _R.RIGHT_KNEE: (_R.RIGHT_UPPER_LEG, (0, -0.245, 0)),
    _R.RIGHT_FOOT: (_R.RIGHT_KNEE, (0, -0.246, 0)),
    _R.RIGHT_TOES: (_R.RIGHT_FOOT, (0, -0.03, 0.08)),
}
BODY_ROLES: tuple[JointRole, ...] = tuple(_BODY)
"""The joints of the canonical body, in the order of its skeleton."""

_COLUMN = {role: column for column, role in enumerate(BODY_ROLES)}
_LEGS = (
    (_R.LEFT_UPPER_LEG, _R.LEFT_KNEE, _R.LEFT_FOOT),
    (_R.RIGHT_UPPER_LEG, _R.RIGHT_KNEE, _R.RIGHT_FOOT),
)
_FEET = [_COLUMN[_R.LEFT_FOOT], _COLUMN[_R.RIGHT_FOOT]]
_Points = dict[JointRole, FloatArray]


def canonical_body() -> Skeleton:
    """The skeleton of the canonical body, in meters, Y up. Its joints have the names of roles.

    In the rest pose, the ankles are ANKLE_HEIGHT above the floor.
    """
    above = (role for role, _ in _BODY.values())
    return Skeleton(
        names=tuple(role.value for role in BODY_ROLES),
        parents=np.array([-1 if role is None else _COLUMN[role] for role in above]),
        offsets=STATURE * np.array([offset for _, offset in _BODY.values()], dtype=np.float64),
    )


def on_canonical_body(motion: Motion) -> Animation:
    """The movement of `motion` on the canonical body, in meters, Y up, at the same frame rate."""
    body, points = canonical_body(), _points(motion)
    rotations = solve_rotations(body, _bones(body, points, motion.frames))
    scale = _leg_length(body.offsets) / max(_leg_length_of(points), MIN_LEG_LENGTH)
    roots = points[_R.HIPS] * scale
    posed = forward_kinematics(body, rotations, local_translations(body, roots))
    roots[:, 1] += _target_height(points, scale) - posed[:, _FEET, 1].min(axis=1)
    return Animation(body, rotations, local_translations(body, roots), motion.frame_rate)


def _points(motion: Motion) -> _Points:
    """(frames, 3) float64 positions of each role, in meters.

    A missing chest or upper leg is estimated from hips, neck, and the line from right to left.
    """
    points: _Points = {
        role: motion.positions[:, joint].astype(np.float64) for role, joint in motion.roles.items()
    }
    hips, neck = points[_R.HIPS], points[_R.NECK]
    points.setdefault(_R.CHEST, hips + CHEST_SHARE * (neck - hips))
    left, right = points[_R.LEFT_KNEE], points[_R.RIGHT_KNEE]
    across = points.get(_R.LEFT_SHOULDER, left) - points.get(_R.RIGHT_SHOULDER, right)
    width = np.linalg.norm(across, axis=-1, keepdims=True)
    side = across / np.maximum(width, 1e-9) * 0.3 * np.linalg.norm(neck - hips, axis=-1)[:, None]
    points.setdefault(_R.LEFT_UPPER_LEG, hips + 0.5 * side)
    points.setdefault(_R.RIGHT_UPPER_LEG, hips - 0.5 * side)
    return points


def _bones(body: Skeleton, points: _Points, frames: int) -> FloatArray:
    """(frames, joints, 3) world vectors along the body's bones, in meters; 0 without both ends."""
    bones = np.zeros((frames, len(body), 3))
    for role, column in _COLUMN.items():
        above = _BODY[role][0]
        if above in points and role in points:
            bones[:, column] = points[role] - points[above]
    return bones


def _leg_length(offsets: FloatArray) -> float:
    """The length of thigh and shank of the body at rest, in meters."""
    return float(sum(np.linalg.norm(offsets[_COLUMN[role]]) for role in _LEGS[0][1:]))


def _leg_length_of(points: _Points) -> float:
    """The median length of thigh and shank of a clip, in meters; without a foot, of two thighs."""
    lengths = []
    for hip, knee, foot in _LEGS:
        thigh = np.linalg.norm(points[hip] - points[knee], axis=-1)
        shank = np.linalg.norm(points[foot] - points[knee], axis=-1) if foot in points else thigh
        lengths.append(float(np.median(thigh) + np.median(shank)))
    return float(np.mean(lengths))


def _target_height(points: _Points, scale: float) -> FloatArray:
    """(frames,) the height of the lower ankle of the body, in meters: that of the clip, scaled."""
    feet = [points.get(foot, points[knee])[:, 1] for _, knee, foot in _LEGS]
    lower = np.min(feet, axis=0)
    floor = np.percentile(lower, FLOOR_PERCENTILE)
    return np.asarray(ANKLE_HEIGHT + scale * (lower - floor))
