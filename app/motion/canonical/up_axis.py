"""Finds the axis that points up, and turns it to Y.

An axis that the file says outright, or that a client says, is never judged. Else the usual axis of
the format is up, unless the evidence is against it. The body stands along an axis if this leads
from the feet to the hips and from the hips to the head. People also lie down, and walk on their
hands. So if the body stands along another axis in most frames, this is up only if one of
these holds:

1. The rest pose stands along it, too.
2. The body walks: the hips travel level, and one foot stands while they do.
3. The body is straight, and by the usual axis it would be below the floor, or float above it. A
   lying body lies on something.
4. Only the lower body was recorded, and the legs are straight: it is a person in a gait laboratory.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

import numpy as np

from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.recording import Caution
from app.motion.skeleton.resampling import some_frames
from app.numerics.arrays import BoolArray, FloatArray

MIN_HEIGHT_RATIO = 2.0
"""The height of the head above the feet along another axis must be larger, by this factor, than
their distance along the usual axis."""
MIN_SHARE_ALONG = 0.5
"""The smallest cosine between trunk or legs and an axis along which the body stands."""
MIN_STRAIGHT = 0.8
"""The smallest cosine between trunk or legs and the axis of a straight body. Who crawls has
less."""
MOST_FRAMES, FEW_FRAMES = 0.6, 0.05
"""The share of frames in which a body must stand along another axis, and the largest share in which
it may stand along the usual one. People bend down meanwhile."""
MOST_STRAIGHT_FRAMES = 0.8
"""The share of frames in which a straight body is straight."""
MAX_SAMPLED_FRAMES = 64
"""The most frames, evenly spaced, in which postures are measured."""
MAX_BELOW_FLOOR, MAX_ABOVE_FLOOR = 0.06, 0.55
"""The lowest joint of a body that lies: statures below the origin, and above it (on a bed)."""
MIN_TRAVEL, MAX_TRAVEL_SLOPE = 0.5, 0.35
"""The smallest distance in statures that the hips travel in a walk, and the largest change of their
height as a share of it."""
MAX_STANCE_SPEED = 0.4
"""The largest speed of the slower foot in a walk, as a share of the speed of the hips."""

_TO_Y_UP: dict[str, list[list[int]]] = {
    "x": [[0, -1, 0], [1, 0, 0], [0, 0, 1]],
    "y": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
    "z": [[1, 0, 0], [0, 0, 1], [0, -1, 0]],
    "-x": [[0, 1, 0], [-1, 0, 0], [0, 0, 1]],
    "-y": [[1, 0, 0], [0, -1, 0], [0, 0, -1]],
    "-z": [[1, 0, 0], [0, 0, -1], [0, 1, 0]],
}
"""The rotation that brings each axis to Y. None is a mirror, so a right-handed body stays so."""
UP_AXES = tuple(_TO_Y_UP)
"""The axes that a client may give."""

_R = JointRole


def judge_up_axis(
    positions: FloatArray,
    rest: FloatArray | None,
    roles: Mapping[JointRole, int],
    usual: str,
) -> tuple[str, tuple[Caution, ...]]:
    """The axis that points up, one of UP_AXES, and a caution if it is not the usual one.

    positions: (frames, joints, 3) in any unit. rest: (joints, 3) the positions if all rotations are
    0, or None if the file has no rotations. roles: the joint of each role. usual: the axis that is
    usual in the format. The caution is also given if the body seems to lie in all frames, and could
    stand along another axis.
    """
    body = _Body(some_frames(positions, MAX_SAMPLED_FRAMES), roles)
    standing = body.standing_axis()
    if standing is None or standing == usual or not body.stands_along(standing, usual):
        return usual, ()
    resting = None if rest is None else _Body(rest[None], roles).standing_axis()
    is_straight = body.is_straight(standing)
    if (
        resting == standing
        or (is_straight and body.is_lower_body)
        or (is_straight and body.is_off_the_floor(usual))
        or _walks(positions, roles, standing, body.stature)
    ):
        detail = f"the body stands along {standing}, not {usual}; turned to Y up"
        return standing, (Caution("up_axis_guessed", detail),)
    if not is_straight:
        return usual, ()
    detail = (
        f"the body lies, or is upside down, in nearly all frames, if {usual} is up; if it stands,"
        f" send up_axis {standing}"
    )
    return usual, (Caution("up_axis_suspect", detail),)


def to_y_up(positions: FloatArray, up_axis: str) -> FloatArray:
    """(..., 3) `positions` (..., 3), turned so that `up_axis` becomes Y. The unit stays."""
    if up_axis == "y":
        return positions
    turn = np.array(_TO_Y_UP[up_axis], dtype=positions.dtype)
    return np.asarray(positions @ turn.T)


class _Body:
    """The posture of a body. positions: (frames, joints, 3) in any unit."""

    def __init__(self, positions: FloatArray, roles: Mapping[JointRole, int]) -> None:
        self._positions, self._roles = positions, roles
        hips, top = roles.get(_R.HIPS), roles.get(_R.HEAD, roles.get(_R.NECK))
        low = _lower_ends(roles)
        self.is_known = hips is not None and bool(low)
        self.is_lower_body = top is None
        if hips is None or not low:
            return
        middle = positions[:, hips].astype(np.float64)
        self.legs = middle - positions[:, low].mean(axis=1)
        self.trunk = self.legs if top is None else positions[:, top] - middle
        self.over_feet = self.trunk + self.legs

    @cached_property
    def stature(self) -> float:
        """About the length of the body in the unit of the positions."""
        trunk, legs = (np.linalg.norm(part, axis=1) for part in (self.trunk, self.legs))
        return float(np.median(trunk) + np.median(legs))

    def standing_axis(self) -> str | None:
        """The signed axis along which the body stands in most frames; None if there is none."""
        if not self.is_known or not np.any(self.over_feet):
            return None
        mean = self.over_feet.mean(axis=0)
        index = int(np.argmax(np.abs(mean)))
        axis = ("-" if mean[index] < 0 else "") + "xyz"[index]
        return axis if float(np.mean(self._stands(axis))) >= MOST_FRAMES else None

    def stands_along(self, axis: str, usual: str) -> bool:
        """Whether the body stands along `axis` and hardly ever along the usual one."""
        upright = np.abs(self.over_feet.mean(axis=0))
        ratio = MIN_HEIGHT_RATIO if axis[-1] != usual[-1] else 0.0
        if upright["xyz".index(axis[-1])] < ratio * upright["xyz".index(usual[-1])]:
            return False
        return float(np.mean(self._stands(usual))) <= FEW_FRAMES

    def is_off_the_floor(self, up_axis: str) -> bool:
        """Whether the body is below the origin, or floats above it, if this axis is up."""
        joints = self._positions[:, sorted(set(self._roles.values()))].astype(np.float64)
        heights = joints @ direction_of(up_axis)
        lowest = float(np.percentile(heights.min(axis=1), 5)) / max(self.stature, 1e-12)
        return not -MAX_BELOW_FLOOR <= lowest <= MAX_ABOVE_FLOOR

    def is_straight(self, axis: str) -> bool:
        """Whether trunk and legs are nearly parallel to `axis` in most frames."""
        return float(np.mean(self._stands(axis, MIN_STRAIGHT))) >= MOST_STRAIGHT_FRAMES

    def _stands(self, axis: str, share: float = MIN_SHARE_ALONG) -> BoolArray:
        """(frames,) whether both trunk and legs lead up, if `axis` is up.

        share: the smallest cosine between each of them and the axis.
        """
        up = direction_of(axis)
        trunk, legs = (
            part @ up > share * np.linalg.norm(part, axis=1) for part in (self.trunk, self.legs)
        )
        return np.asarray(trunk & legs)


def direction_of(axis: str) -> FloatArray:
    """(3,) the unit vector of a signed axis."""
    direction = np.zeros(3)
    direction["xyz".index(axis[-1])] = -1.0 if axis.startswith("-") else 1.0
    return direction


def _walks(
    positions: FloatArray, roles: Mapping[JointRole, int], up_axis: str, stature: float
) -> bool:
    """Whether the hips travel level, and the slower foot stands, if `up_axis` is up."""
    turned = to_y_up(positions[:, [roles[_R.HIPS], *_lower_ends(roles)]], up_axis)
    hips = turned[:, 0].astype(np.float64)
    travel = float(np.linalg.norm(np.ptp(hips[:, [0, 2]], axis=0)))
    if travel < MIN_TRAVEL * stature or np.ptp(hips[:, 1]) > MAX_TRAVEL_SLOPE * travel:
        return False
    speeds = np.linalg.norm(np.diff(turned.astype(np.float64), axis=0), axis=-1)
    slower_foot = speeds[:, 1:].min(axis=1)
    return bool(np.median(slower_foot) < MAX_STANCE_SPEED * np.median(speeds[:, 0]))


def _lower_ends(roles: Mapping[JointRole, int]) -> list[int]:
    """The joints of both feet, or else of both knees; empty if there are none."""
    pairs = ((_R.LEFT_FOOT, _R.RIGHT_FOOT), (_R.LEFT_KNEE, _R.RIGHT_KNEE))
    return next(([roles[a], roles[b]] for a, b in pairs if a in roles and b in roles), [])
