"""Poses of parts at times, and curves through them on top of an actor's own posture.

Keys are (time s, pose); a pose of None is the actor's posture at ease. Radians and meters.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.demo.controls import Arm, Foot, Turn
from app.demo.curves import keyed
from app.numerics.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class ArmPose:
    """One arm at one moment, as in `Arm`; absolute, the trunk's frame."""

    flex: float
    abduct: float
    twist: float
    elbow: float
    wrist: float = 0.1


@dataclass(frozen=True, slots=True)
class FootPose:
    """One foot at one moment, as in `Foot`: offset from the place at ease, pitch, extra yaw."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    pitch: float = 0.0
    yaw: float = 0.0


ArmKey = tuple[float, ArmPose | None]
FootKey = tuple[float, FootPose]
TurnKey = tuple[float, tuple[float, float, float]]
PlaceKey = tuple[float, tuple[float, float, float]]


def arm_through(times: FloatArray, rest: Arm, keys: Sequence[ArmKey], soften: float) -> Arm:
    """An arm going through `keys`."""
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
    ease = float(rest[0])
    return keyed(times, [(t, ease if value is None else value) for t, value in keys], soften)


def foot_through(times: FloatArray, rest: Foot, keys: Sequence[FootKey]) -> Foot:
    """A foot going through `keys`; it rests where two following keys are the same."""
    x, y, z, pitch, yaw = (
        keyed(times, [(t, float(getattr(pose, name))) for t, pose in keys])
        for name in ("x", "y", "z", "pitch", "yaw")
    )
    place = rest.place + np.stack([x, np.maximum(y, 0.0), z], axis=-1)
    return Foot(place=place, pitch=rest.pitch + pitch, yaw=rest.yaw + yaw)


def turned(times: FloatArray, rest: Turn, keys: Sequence[TurnKey], soften: float) -> Turn:
    """`rest` and, added to it, (yaw, pitch, roll) through `keys`."""
    yaw, pitch, roll = (
        keyed(times, [(t, pose[axis]) for t, pose in keys], soften) for axis in range(3)
    )
    return Turn(rest.yaw + yaw, rest.pitch + pitch, rest.roll + roll)


def placed(
    times: FloatArray, rest: FloatArray, keys: Sequence[PlaceKey], soften: float
) -> FloatArray:
    """`rest` (frames, 3) and, added to it, offsets (x, y, z) in meters through `keys`."""
    axes = [keyed(times, [(t, pose[axis]) for t, pose in keys], soften) for axis in range(3)]
    return rest + np.stack(axes, axis=-1)
