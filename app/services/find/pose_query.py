"""The query of a search by pose: the pose of a motion at a time, or 13 positions from a client."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from app.analysis.descriptors.pose_cover import pose_vectors
from app.errors import BadField
from app.kinedex_error import Place
from app.motion.frame.body_frame import ANALYSIS_RATE
from app.motion.frame.body_pose import SIDES
from app.motion.roles.joint_roles import SUN_ROLES
from app.motion.skeleton.resampling import sample_at
from app.numerics.arrays import FloatArray
from app.services import fields

MAX_COORDINATE = 1e6
"""Meters. A larger coordinate is a mistake of the client."""

_WHOLE_FRAME = 1e-6
"""Frames. A time nearer than this to a frame is the time of the frame, in spite of rounding."""
_ORDER = ", ".join(SUN_ROLES)


def pose_at(positions: FloatArray, time: float, duration: float) -> FloatArray:
    """(36,) vector of the pose at `time` seconds, of positions (n, 13, 3) at ANALYSIS_RATE.

    Between frames the pose is interpolated. Raises BadField for a time outside of the motion, and
    for a pose without a size.
    """
    if not (math.isfinite(time) and 0 <= time <= duration):
        raise fields.bad_field("time", f"must be from 0 to the duration, {duration:.3f} s")
    frame = time * ANALYSIS_RATE
    if abs(frame - round(frame)) < _WHOLE_FRAME:
        frame = round(frame)
    pose = sample_at(positions.astype(np.float64), np.array([frame]))
    vector = pose_vectors(pose.astype(np.float32))[0]
    if not np.isfinite(vector).all():
        raise fields.bad_field("time", "the body has no size, or no left and right, at that time")
    return np.asarray(vector)


def pose_of(positions: Sequence[Sequence[Any]]) -> FloatArray:
    """(36,) vector of a pose: 13 positions (x, y, z) in SUN_ROLES order, Y up, in any unit.

    Raises BadField, which names every joint that cannot be used.
    """
    if len(positions) != len(SUN_ROLES):
        message = f"expected {len(SUN_ROLES)} points ({_ORDER}), found {len(positions)}"
        raise _refused([Place("positions", message)])
    bad = [
        Place(f"positions.{index}", f"{role}: {problem}")
        for index, (role, point) in enumerate(zip(SUN_ROLES, positions, strict=True))
        if (problem := _problem(point))
    ]
    if bad:
        raise _refused(bad)
    points = np.array(positions, dtype=np.float64)
    vector = pose_vectors(points[None])[0]
    if not np.isfinite(vector).all():
        raise _refused(_without_a_body(points))
    return np.asarray(vector)


def _problem(point: Any) -> str | None:
    expected = "expected x, y and z, finite numbers of meters"
    if not isinstance(point, list | tuple) or len(point) != 3:
        return expected
    numbers = [isinstance(n, int | float) and not isinstance(n, bool) for n in point]
    # An int may be too large for a float, and isfinite would raise OverflowError.
    if not all(numbers) or not all(math.isfinite(n) for n in point if isinstance(n, float)):
        return expected
    return f"farther than {MAX_COORDINATE:g} m" if max(map(abs, point)) > MAX_COORDINATE else None


def _without_a_body(points: FloatArray) -> list[Place]:
    """The reasons why finite positions (13, 3) have no pose vector."""
    if (points == points[0]).all():
        return [Place("positions", "all joints have the same position: the body has no size")]
    places = []
    for left, right in SIDES:
        left_joint, right_joint = SUN_ROLES.index(left), SUN_ROLES.index(right)
        # The heading comes from the horizontal direction (x, z) from a left joint to a right one.
        if np.hypot(*(points[left_joint] - points[right_joint])[[0, 2]]) < 1e-6:
            message = f"{left} and {right} have the same x and z: the body has no left and right"
            places.append(Place(f"positions.{left_joint}", message))
    if len(places) == len(SIDES):
        return places
    message = "hips, neck, head, knees and feet have the same position: the body has no size"
    return [Place("positions", message)]


def _refused(places: list[Place]) -> BadField:
    return BadField("The pose cannot be used.", places=places)
