"""Keys (poses of body parts at given times), and the curves through them.

A key is a pair of a time in seconds and a pose. The pose None is the resting posture of the actor.
Units are radians and meters.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.demo.controls import Arm, Foot, Turn
from app.demo.curves import keyed_curve
from app.numerics.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class ArmPose:
    """The pose of an arm, with the angles of `Arm` in the frame of the trunk."""

    flex: float
    abduct: float
    twist: float
    elbow: float
    wrist: float = 0.1


@dataclass(frozen=True, slots=True)
class FootPose:
    """The pose of a foot: its offset from the resting position, pitch, and additional yaw."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    pitch: float = 0.0
    yaw: float = 0.0


ArmKey = tuple[float, ArmPose | None]
FootKey = tuple[float, FootPose]
TurnKey = tuple[float, tuple[float, float, float]]
OffsetKey = tuple[float, tuple[float, float, float]]


def arm_curves(times: FloatArray, rest: Arm, keys: Sequence[ArmKey], soften: float) -> Arm:
    """The curves of an arm through `keys`; rest: the resting posture."""
    return Arm(
        *(
            _channel(times, getattr(rest, name), [(t, _get(p, name)) for t, p in keys], soften)
            for name in ("flex", "abduct", "twist", "elbow", "wrist")
        )
    )


def _get(pose: ArmPose | None, name: str) -> float | None:
    return None if pose is None else float(getattr(pose, name))


def _channel(
    times: FloatArray, rest: FloatArray, keys: Sequence[tuple[float, float | None]], soften: float
) -> FloatArray:
    resting = float(rest[0])
    points = [(t, resting if value is None else value) for t, value in keys]
    return keyed_curve(times, points, soften)


def foot_curves(times: FloatArray, rest: Foot, keys: Sequence[FootKey]) -> Foot:
    """The curves of a foot through `keys`. It does not move between two equal keys."""
    x, y, z, pitch, yaw = (
        keyed_curve(times, [(t, float(getattr(pose, name))) for t, pose in keys])
        for name in ("x", "y", "z", "pitch", "yaw")
    )
    # interpolation may give tiny negative heights, which would be below the floor
    position = rest.position + np.stack([x, np.maximum(y, 0.0), z], axis=-1)
    return Foot(position=position, pitch=rest.pitch + pitch, yaw=rest.yaw + yaw)


def turn_curves(times: FloatArray, rest: Turn, keys: Sequence[TurnKey], soften: float) -> Turn:
    """`rest` plus the angles (yaw, pitch, roll) through `keys`."""
    yaw, pitch, roll = (
        keyed_curve(times, [(t, pose[axis]) for t, pose in keys], soften) for axis in range(3)
    )
    return Turn(rest.yaw + yaw, rest.pitch + pitch, rest.roll + roll)


def offset_curve(
    times: FloatArray, rest: FloatArray, keys: Sequence[OffsetKey], soften: float
) -> FloatArray:
    """(frames, 3) `rest` (frames, 3) plus the offsets (x, y, z), in meters, through `keys`."""
    axes = [keyed_curve(times, [(t, pose[axis]) for t, pose in keys], soften) for axis in range(3)]
    return rest + np.stack(axes, axis=-1)
