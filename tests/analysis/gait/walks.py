"""Walks of which all strikes, lengths and times are known."""

from __future__ import annotations

import numpy as np

from app.motion.motion import Motion
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray
from tests.bodies import motion_of

R = JointRole


def planted_walk(
    *,
    rate: float = 100.0,
    strides: int = 5,
    stride_time: float = 1.1,
    stride_length: float = 1.3,
    stance: float = 0.62,
    width: float = 0.12,
    limp: float = 0.0,
    heading: float = 0.0,
    radius: float | None = None,
) -> Motion:
    """A walk whose feet stand still on the floor from strike to off.

    limp: seconds by which the right foot strikes later than in the middle of the left stride.
    heading: radians from +Z toward +X. radius: meters of a circle to the left; None is straight.
    """
    t = np.arange(round(strides * stride_time * rate)) / rate
    speed = stride_length / stride_time
    along = {"hips": speed * t, "neck": speed * t}
    heights = {}
    for side, late in (("left", 0.0), ("right", 0.5 * stride_time + limp)):
        along[side], heights[side] = _foot(t - late, stride_time, stride_length, stance)
        along[side] = along[side] + speed * late
    body = np.zeros((len(t), len(SUN_ROLES), 3))
    for role in SUN_ROLES:
        side = role.value.partition("_")[0]
        sign = {"left": 1.0, "right": -1.0}.get(side, 0.0)
        path, height = speed * t, _HEIGHTS[role]
        if role.value.endswith("foot"):
            path, height = along[side], height + heights[side]
        elif role.value.endswith("knee"):
            path, height = 0.5 * (along[side] + speed * t), height + 0.5 * heights[side]
        body[:, SUN_ROLES.index(role)] = _placed(path, sign * 0.5 * width, height, radius)
    body[..., 1] -= (
        0.02
        * np.cos(4 * np.pi * t / stride_time)[:, None]
        * (np.array([role.value.endswith("foot") for role in SUN_ROLES]) == 0)
    )
    cos, sin = np.cos(heading), np.sin(heading)
    turned = body @ np.array([[cos, 0, -sin], [0, 1, 0], [sin, 0, cos]])
    return motion_of(turned, rate)


_HEIGHTS = {
    R.HIPS: 0.92, R.NECK: 1.45, R.HEAD: 1.65,
    R.LEFT_KNEE: 0.5, R.RIGHT_KNEE: 0.5, R.LEFT_FOOT: 0.08, R.RIGHT_FOOT: 0.08,
    R.LEFT_SHOULDER: 1.4, R.RIGHT_SHOULDER: 1.4, R.LEFT_ELBOW: 1.1, R.RIGHT_ELBOW: 1.1,
    R.LEFT_HAND: 0.85, R.RIGHT_HAND: 0.85,
}  # fmt: skip


def _foot(
    t: FloatArray, stride_time: float, stride_length: float, stance: float
) -> tuple[FloatArray, FloatArray]:
    """Meters along the way and above the floor: it strikes at t = 0, stride_time, ..."""
    number = np.floor(t / stride_time)
    phase = t / stride_time - number
    swing = np.clip((phase - stance) / (1 - stance), 0, 1)
    # it slows down in the last tenth, so that it is farthest ahead shortly before it lands
    share = np.where(swing < 0.9, swing / 0.95, 1 - (1 - swing) ** 2 / 0.19)
    start = stride_length * (number + 0.5 * stance)
    return start + stride_length * share, 0.1 * np.sin(np.pi * swing)


def _placed(
    along: FloatArray, aside: float, height: FloatArray | float, radius: float | None
) -> FloatArray:
    """(n, 3) points on a way along +Z, or on a circle whose middle is to the left (+X)."""
    if radius is None:
        return np.stack([np.full(len(along), aside), np.broadcast_to(height, len(along)), along], 1)
    angle, r = along / radius, radius - aside
    return np.stack(
        [radius - r * np.cos(angle), np.broadcast_to(height, len(along)), r * np.sin(angle)], 1
    )
