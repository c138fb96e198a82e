"""What the numbers of a sample are: positions of joints, or joint angles.

A sample is `SAMPLES` moments of some channels, then the net turn and the mean speed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from app.analysis.descriptors.angle_poses import poses_of_angles
from app.analysis.descriptors.joint_angles import ANGLES
from app.analysis.descriptors.motion_sample import SAMPLES
from app.motion.frame.body_frame import ANALYSIS_RATE
from app.motion.posing.canonical_body import ANKLE_HEIGHT, BODY_ROLES, canonical_body
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.motion.skeleton.kinematics import rest_positions
from app.motion.skeleton.resampling import resample_to
from app.numerics.arrays import FloatArray

_R = JointRole
_FEET = [SUN_ROLES.index(role) for role in (_R.LEFT_FOOT, _R.RIGHT_FOOT)]


@dataclass(frozen=True, slots=True)
class Parts:
    """A sample in parts: curves (SAMPLES, channels); turn: the asinh of the net turn in radians;
    speed: mean horizontal speed of the hips, body lengths per second."""

    curves: FloatArray
    turn: float
    speed: float


@dataclass(frozen=True, slots=True)
class Coordinates:
    """The coordinates of samples.

    name, unit: of the channels; channels: their names; poses: from curves (n, channels) to
    positions (n, 13, 3), meters, Y up, of a body that faces Z, with the hips at the origin.
    """

    name: Literal["positions", "angles"]
    unit: str
    channels: tuple[str, ...]
    poses: Callable[[FloatArray], FloatArray]

    def parts(self, sample: FloatArray) -> Parts:
        """The parts of a sample (w,)."""
        curves = np.reshape(sample[:-2], (SAMPLES, len(self.channels)))
        return Parts(curves, float(sample[-2]), float(sample[-1]))

    def played(self, sample: FloatArray, seconds: float) -> FloatArray:
        """(n, 13, 3) a sample (w,) as a motion at ANALYSIS_RATE: meters, Y up, in SUN_ROLES order.

        seconds: the duration; a sample has none. The body is as tall as the canonical one, and
        stays in place. In each frame its lower ankle is at the height of a standing one, because a
        sample does not contain the height of the hips.
        """
        frames = max(round(seconds * ANALYSIS_RATE), 2)
        positions = self.poses(resample_to(self.parts(sample).curves, frames))
        lower = positions[:, _FEET, 1].min(axis=1)
        positions[..., 1] += (ANKLE_HEIGHT - lower)[:, None]
        return positions


def _scaled(curves: FloatArray) -> FloatArray:
    """(n, 13, 3) meters, from positions (n, 39) in body lengths."""
    return np.asarray(curves.reshape(-1, len(SUN_ROLES), 3) * _body_length())


def _body_length() -> float:
    """The body length (see `body_frame`) of the canonical body, in meters."""
    rest = dict(zip(BODY_ROLES, rest_positions(canonical_body()), strict=True))
    parts = ((_R.HIPS, _R.NECK), (_R.NECK, _R.HEAD), (_R.LEFT_KNEE, _R.LEFT_FOOT))
    return float(sum(np.linalg.norm(rest[end] - rest[start]) for start, end in parts))


POSITIONS = Coordinates(
    "positions",
    "body lengths",
    tuple(f"{role.value}_{axis}" for role in SUN_ROLES for axis in "xyz"),
    _scaled,
)
"""Positions of the joint roles in the body frame: X left, Y up, Z forward (see motion_sample)."""

ANGLES_OF_JOINTS = Coordinates("angles", "radians", ANGLES, poses_of_angles)
"""Joint angles, as in the paper (see angle_sample)."""
