"""Motions of simple bodies, computed from sines at any frame rate, for tests of invariances."""

from __future__ import annotations

import numpy as np

from app.motion.motion import Motion
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray

R = JointRole


def motion_of(positions: FloatArray, frame_rate: float = 30.0) -> Motion:
    """A canonical motion of Sun's 13 roles from positions (frames, 13, 3) in meters."""
    return Motion(
        format="bvh",
        names=tuple(role.value for role in SUN_ROLES),
        parents=np.array(
            [SUN_ROLES.index(r.toward_trunk()) if r is not R.HIPS else -1 for r in SUN_ROLES]
        ),
        positions=positions.astype(np.float32),
        roles={role: index for index, role in enumerate(SUN_ROLES)},
        missing_roles=(),
        frame_rate=frame_rate,
        declared_frame_rate=frame_rate,
        metres_per_unit=1.0,
    )


def walking(
    seconds: float = 4.0,
    rate: float = 30.0,
    *,
    steps_hz: float = 0.9,
    speed: float = 1.2,
    turn: float = 0.0,
    arm: float = 0.3,
) -> FloatArray:
    """(frames, 13, 3) m: a walk along Z with `steps_hz` cycles per second.

    speed: m/s; turn: rate of turning about Y, rad/s; arm: amplitude of the hands, m.
    """
    t = np.arange(round(seconds * rate) + 1) / rate
    phase = 2 * np.pi * steps_hz * t
    body = _standing(len(t))
    for side, sign in (("left", 1.0), ("right", -1.0)):
        swing = np.sin(phase) * sign
        lift = np.maximum(0.0, np.cos(phase) * sign) ** 2
        _move(body, f"{side}_knee", z=0.18 * swing + 0.1 * lift, y=0.05 * lift)
        _move(body, f"{side}_foot", z=0.35 * swing, y=0.12 * lift)
        _move(body, f"{side}_elbow", z=-0.5 * arm * swing)
        _move(body, f"{side}_hand", z=-arm * swing)
    body[..., 1] += (0.03 * np.cos(2 * phase))[:, None]
    angle = turn * t
    along = np.cumsum(np.stack([np.sin(angle), 0 * t, np.cos(angle)], 1), axis=0) * speed / rate
    return turned_about_y(body, angle) + (along - along[0])[:, None]


def waving(seconds: float = 4.0, rate: float = 30.0, *, hz: float = 1.5) -> FloatArray:
    """(frames, 13, 3) m: the body stands, and the raised right hand waves sideways."""
    t = np.arange(round(seconds * rate) + 1) / rate
    body = _standing(len(t))
    _move(body, "right_elbow", x=-0.15 + 0 * t, y=0.25 + 0 * t)
    _move(body, "right_hand", x=-0.15 + 0.2 * np.sin(2 * np.pi * hz * t), y=0.8 + 0 * t)
    return body


def standing(frames: int = 60) -> FloatArray:
    """(frames, 13, 3) m: the body stands and nothing moves."""
    return _standing(frames)


def turned_about_y(points: FloatArray, angle: FloatArray | float) -> FloatArray:
    """(frames, 13, 3) turned about Y, from Z towards X.

    angle: radians, one for all frames or one for each frame (frames,).
    """
    a = np.broadcast_to(np.asarray(angle), len(points))[:, None]
    x, y, z = points[..., 0], points[..., 1], points[..., 2]
    return np.stack([np.cos(a) * x + np.sin(a) * z, y, np.cos(a) * z - np.sin(a) * x], -1)


def _standing(frames: int) -> FloatArray:
    positions = {
        R.HIPS: (0, 0.95, 0), R.NECK: (0, 1.45, 0), R.HEAD: (0, 1.65, 0.03),
        R.LEFT_KNEE: (0.1, 0.5, 0.02), R.RIGHT_KNEE: (-0.1, 0.5, 0.02),
        R.LEFT_FOOT: (0.1, 0.08, 0), R.RIGHT_FOOT: (-0.1, 0.08, 0),
        R.LEFT_SHOULDER: (0.18, 1.4, 0), R.RIGHT_SHOULDER: (-0.18, 1.4, 0),
        R.LEFT_ELBOW: (0.22, 1.12, -0.02), R.RIGHT_ELBOW: (-0.22, 1.12, -0.02),
        R.LEFT_HAND: (0.24, 0.87, 0.05), R.RIGHT_HAND: (-0.24, 0.87, 0.05),
    }  # fmt: skip
    return np.tile(np.array([positions[role] for role in SUN_ROLES], dtype=float), (frames, 1, 1))


def _move(body: FloatArray, role: str, **by: FloatArray) -> None:
    for axis, values in by.items():
        body[:, SUN_ROLES.index(JointRole(role)), "xyz".index(axis)] += values


def move_joint(body: FloatArray, role: JointRole, by: FloatArray) -> None:
    """Add (frames, 3) to one joint of `body` (frames, 13, 3), which is changed."""
    body[:, SUN_ROLES.index(role)] += by
