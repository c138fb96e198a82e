"""Joints and limbs: angles beyond human limits, limbs that merge, ranges, and the leading side."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.analysis.quality.definitions import RANGED
from app.motion.frame.body_frame import BodyTrack
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import BoolArray, FloatArray, IntArray

_R = JointRole
MAX_BEND, MAX_FORWARD, MAX_NECK = 160.0, 15.0, 100.0
"""Degrees: of knees and elbows, of knees to the front, and of the head against the trunk."""

HANGING = -0.7
"""The height of a thigh's direction: it hangs within 45 degrees."""

EXTREMES = (0.05, 0.95)
"""Quantiles between which a joint's range lies. A few bad frames change them little."""

CONTACT_RATE = 10.0
"""Hz at which limbs are compared: a touch lasts longer."""

POINTS = 6
"""Points on each limb whose distances are compared."""

REST = 1e-3
"""Body lengths per second that hardly count as movement."""

MIN_LENGTH = 1e-9
"""Body lengths: a shorter bone has no direction."""

_LIMBS: dict[str, tuple[JointRole, JointRole, float]] = {
    "trunk": (_R.HIPS, _R.NECK, 0.07),
    "head": (_R.NECK, _R.HEAD, 0.05),
    "left_forearm": (_R.LEFT_ELBOW, _R.LEFT_HAND, 0.02),
    "right_forearm": (_R.RIGHT_ELBOW, _R.RIGHT_HAND, 0.02),
    "left_shin": (_R.LEFT_KNEE, _R.LEFT_FOOT, 0.03),
    "right_shin": (_R.RIGHT_KNEE, _R.RIGHT_FOOT, 0.03),
    "left_thigh": (_R.HIPS, _R.LEFT_KNEE, 0.04),
    "right_thigh": (_R.HIPS, _R.RIGHT_KNEE, 0.04),
}
"""Start, end, and radius in body lengths of each limb."""

_TOUCHING = (
    ("left_forearm", "right_forearm"),
    ("left_shin", "right_shin"),
    *(
        (f"{side}_forearm", other)
        for side in ("left", "right")
        for other in ("trunk", "head", "left_thigh", "right_thigh", "left_shin", "right_shin")
    ),
)
_ARMS_AND_LEGS = ("left_elbow", "right_elbow", "left_knee", "right_knee")
_BENDS = ("neck", *_ARMS_AND_LEGS)
_SWINGS = ("left_shoulder", "right_shoulder", "left_hip", "right_hip")


def _index(role: JointRole) -> int:
    return SUN_ROLES.index(role)


def _merged() -> FloatArray:
    """(p, p) the squared distance from which each pair of points has merged; -1 for no such."""
    names = list(_LIMBS)
    limits = np.full((len(names), len(names)), -1.0)
    for one, other in _TOUCHING:
        radius = max(_LIMBS[one][2], _LIMBS[other][2])
        limits[names.index(one), names.index(other)] = radius**2
    return np.repeat(np.repeat(limits, POINTS, axis=0), POINTS, axis=1)


_MERGED = _merged()
_LIMB_ENDS = np.array([[_index(start), _index(end)] for start, end, _ in _LIMBS.values()])
_BONES = np.array(
    [
        [_index(start), _index(end)]
        for start, end in (
            (_R.HIPS, _R.NECK),
            (_R.NECK, _R.HEAD),
            (_R.LEFT_SHOULDER, _R.LEFT_ELBOW),
            (_R.RIGHT_SHOULDER, _R.RIGHT_ELBOW),
            (_R.HIPS, _R.LEFT_KNEE),
            (_R.HIPS, _R.RIGHT_KNEE),
            (_R.LEFT_ELBOW, _R.LEFT_HAND),
            (_R.RIGHT_ELBOW, _R.RIGHT_HAND),
            (_R.LEFT_KNEE, _R.LEFT_FOOT),
            (_R.RIGHT_KNEE, _R.RIGHT_FOOT),
        )
    ]
)
_TRUNK, _FIRSTS, _SECONDS, _SWINGING = 0, [0, 2, 3, 4, 5], [1, 6, 7, 8, 9], [2, 3, 4, 5]
"""Places in _BONES: the trunk, both bones of each of _BENDS, and the bones of _SWINGS."""

_MAX_BENDS = np.array([MAX_NECK, MAX_BEND, MAX_BEND, MAX_BEND, MAX_BEND])
_KNEES = [_BENDS.index("left_knee"), _BENDS.index("right_knee")]
_LEGS = (
    [_index(_R.LEFT_KNEE), _index(_R.RIGHT_KNEE)],
    [_index(_R.LEFT_FOOT), _index(_R.RIGHT_FOOT)],
)
_SIDES = tuple(
    [
        place
        for place, role in enumerate(SUN_ROLES)
        if role.value.startswith(side) and not role.value.endswith("shoulder")
    ]
    for side in ("left", "right")
)


@dataclass(frozen=True, slots=True)
class Angles:
    """Degrees in each of n frames, NaN where a bone has no length.

    bends: (n, 5) of _BENDS, 0 for a straight joint. lean: (n,) of the trunk, against the vertical.
    swings: (n, 4) of the first bones of arms and legs, away from their mean direction in the body
    frame. forward: (n, 2) of the knees, to the front.
    """

    bends: FloatArray
    lean: FloatArray
    swings: FloatArray
    forward: FloatArray


def angles_of(track: BodyTrack) -> Angles:
    """The angles of a smoothed track."""
    local = track.local
    bones = _unit(local[:, _BONES[:, 1]] - local[:, _BONES[:, 0]])  # (n, 9, 3)
    bends = _degrees((bones[:, _FIRSTS] * bones[:, _SECONDS]).sum(axis=2))
    centers = _unit(bones[:, _SWINGING].mean(axis=0))
    swings = _degrees((bones[:, _SWINGING] * centers).sum(axis=2))
    forward = np.where(_bends_forward(local), bends[:, _KNEES], 0.0)
    return Angles(bends, _degrees(bones[:, _TRUNK, 1]), swings, forward)


def joint_limits(angles: Angles) -> float:
    """The share of frames in which a joint is beyond its limits; see `definitions`."""
    # a bone without length has no angle: NaN is not beyond a limit
    beyond = (angles.bends > _MAX_BENDS).any(axis=1) | (angles.forward > MAX_FORWARD).any(axis=1)
    return float(beyond.mean())


def ranges(angles: Angles) -> dict[str, float]:
    """Degrees by measure: the range of each of RANGED; NaN for a joint without bones."""
    turning = np.column_stack([angles.lean, angles.bends])
    low, high = np.sort(turning, axis=0)[_places(len(turning))]
    cones = 2.0 * np.sort(angles.swings, axis=0)[_places(len(turning))[1]]
    names = ("trunk", *_BENDS, *_SWINGS)
    found = dict(zip(names, (*(high - low).tolist(), *cones.tolist()), strict=True))
    return {f"range_{name}": found[name] for name in RANGED}


def self_contact(track: BodyTrack) -> float:
    """The share of frames in which two limbs merge; see `definitions`."""
    local = track.local[:: max(1, round(track.rate / CONTACT_RATE))]
    along = np.linspace(0.0, 1.0, POINTS)[:, None]
    start, end = (local[:, _LIMB_ENDS[:, side], None] for side in (0, 1))
    points = (start * (1 - along) + end * along).reshape(len(local), -1, 3)  # limb by limb
    squares = np.square(points).sum(axis=2)
    apart = squares[:, :, None] + squares[:, None] - 2 * points @ points.transpose(0, 2, 1)
    return float((apart < _MERGED).any(axis=(1, 2)).mean())


def dominance(track: BodyTrack) -> float:
    """The lead of the left side, -1..1; 0 for a body at rest."""
    speeds = np.linalg.norm(np.diff(track.local, axis=0), axis=2).mean(axis=0) * track.rate
    left, right = (float(speeds[joints].sum()) for joints in _SIDES)
    return (left - right) / (left + right + REST)


def _bends_forward(local: FloatArray) -> BoolArray:
    """(n, 2) whether a knee of `local` (n, 13, 3) lies behind the line hips - foot.

    Only of a leg whose thigh hangs: of another one, front and back say nothing.
    """
    hips = local[:, [_index(_R.HIPS)]]
    thighs, legs = local[:, _LEGS[0]] - hips, _unit(local[:, _LEGS[1]] - hips)
    behind = thighs[:, :, 2] - (thighs * legs).sum(axis=2) * legs[:, :, 2] < 0
    return np.asarray(behind & (_unit(thighs)[:, :, 1] < HANGING))


def _places(count: int) -> IntArray:
    """(2,) the places of EXTREMES among `count` sorted values."""
    return np.round(np.array(EXTREMES) * (count - 1)).astype(np.int64)


def _degrees(cosines: FloatArray) -> FloatArray:
    return np.asarray(np.degrees(np.arccos(np.clip(cosines, -1.0, 1.0))))


def _unit(vectors: FloatArray) -> FloatArray:
    """(..., 3) `vectors` with length 1; NaN for one without length."""
    lengths = np.sqrt(np.einsum("...x,...x->...", vectors, vectors))[..., None]
    return np.asarray(vectors / np.where(lengths > MIN_LENGTH, lengths, np.nan))
