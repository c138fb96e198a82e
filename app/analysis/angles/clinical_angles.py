"""Joint angles in degrees from the frames of segments.

Hip, knee and ankle: the joint coordinate system of Grood and Suntay (1983), as the International
Society of Biomechanics recommends it (Wu et al. 2002): flexion about Z of the near segment,
adduction about the floating axis, rotation about Y of the far segment (Cardan sequence Z-X-Y).
Thorax relative to pelvis: the same sequence. Pelvis and thorax in the laboratory: rotation,
obliquity, tilt (Y-X-Z; Baker 2001), which keeps the clinical meaning when a person turns. Shoulder:
thorax to humerus by Y-X-Y (Wu et al. 2005), and flexion and adduction by Z-X-Y. Y-X-Y has no plane
of elevation while the arm hangs; Z-X-Y has no flexion if the arm is held out to the side.
"""

from __future__ import annotations

import numpy as np

from app.analysis.angles.definitions import ANGLE_NAMES, SIDES
from app.analysis.angles.segment_frames import SegmentFrames
from app.motion.skeleton.rotations import conjugate, multiply, quaternions_to_euler, rotate
from app.numerics.arrays import FloatArray

_Y = np.array([0.0, 1.0, 0.0])
_Columns = dict[str, FloatArray]
_JOINTS = (
    # near segment, far segment, the three names, the sign of flexion about Z
    ("pelvis", "thigh", ("hip_flexion", "hip_adduction", "hip_internal_rotation"), 1.0),
    ("thigh", "shank", ("knee_flexion", "knee_adduction", "knee_internal_rotation"), -1.0),
    ("shank", "foot", ("ankle_dorsiflexion", "ankle_inversion", "ankle_internal_rotation"), 1.0),
)


def clinical_angles(segments: SegmentFrames, frames: int) -> FloatArray:
    """(frames, angles) degrees, in the order of ANGLE_NAMES; NaN where an angle is not known."""
    found: _Columns = {}
    for name in ("pelvis", "thorax"):
        if name in segments.turns:
            found |= _in_laboratory(name, segments.turns[name])
    if "pelvis" in segments.turns and "thorax" in segments.turns:
        found |= _trunk(segments.turns["pelvis"], segments.turns["thorax"])
    for side in SIDES:
        found |= _leg(segments, side) | _arm(segments, side)
    missing = np.full(frames, np.nan)
    columns = [found.get(name, missing) for name in ANGLE_NAMES]
    return np.asarray(np.degrees(np.column_stack(columns)))


def _in_laboratory(name: str, turns: FloatArray) -> _Columns:
    rotation, obliquity, tilt = quaternions_to_euler(turns, "YXZ").T
    return {
        f"{name}_anterior_tilt_deg": -tilt,
        f"{name}_obliquity_deg": obliquity,
        # the frame's X points forward: a person who faces +Z has turned by -90 degrees
        f"{name}_rotation_deg": _unwrapped(rotation + np.pi / 2),
    }


def _unwrapped(angles: FloatArray) -> FloatArray:
    """(n,) radians without jumps; the first known one is within half a turn of 0."""
    known = np.isfinite(angles)
    if not known.any():
        return angles
    result = np.array(angles)
    steady = np.unwrap(angles[known])
    result[known] = steady - 2 * np.pi * np.round(steady[0] / (2 * np.pi))
    return result


def _trunk(pelvis: FloatArray, thorax: FloatArray) -> _Columns:
    flexion, aside, turn = _cardan(pelvis, thorax)
    return {
        "trunk_flexion_deg": -flexion,
        "trunk_left_lateral_flexion_deg": -aside,
        "trunk_left_rotation_deg": turn,
    }


def _leg(segments: SegmentFrames, side: str) -> _Columns:
    found: _Columns = {}
    for near, far, names, sign in _JOINTS:
        near_name = near if near == "pelvis" else f"{side}_{near}"
        flexion, adduction, rotation = (f"{side}_{name}_deg" for name in names)
        angles = _joint(segments, near_name, f"{side}_{far}", _inward(side))
        if angles is not None:
            found[flexion] = sign * angles[0]
            # heel and toe do not show whether the sole leans
            if far != "foot" or f"{side}_foot" in segments.turns:
                found |= {adduction: angles[1], rotation: angles[2]}
        elif far == "shank":
            bend = _bend(segments, near_name, f"{side}_{far}")
            found |= {} if bend is None else {flexion: bend}
    return found


def _arm(segments: SegmentFrames, side: str) -> _Columns:
    arm, inward = f"{side}_upper_arm", _inward(side)
    found: _Columns = {}
    angles = _joint(segments, "thorax", arm, inward)
    along = _seen_from(segments, "thorax", arm)
    if angles is not None and along is not None:
        flexion, adduction, _ = angles
        plane, elevation = _raised(along, inward)
        found |= {
            f"{side}_shoulder_flexion_deg": flexion,
            f"{side}_shoulder_adduction_deg": adduction,
            f"{side}_shoulder_plane_of_elevation_deg": plane,
            f"{side}_shoulder_elevation_deg": elevation,
        }
        if arm in segments.turns:
            found[f"{side}_shoulder_internal_rotation_deg"] = inward * _axial(
                segments.turns["thorax"], segments.turns[arm]
            )
    bend = _bend(segments, arm, f"{side}_forearm")
    if bend is not None:
        found[f"{side}_elbow_flexion_deg"] = bend
    return found


def _inward(side: str) -> float:
    """The sign with which turns about X and Y go inward: frames are those of a right side."""
    return 1.0 if side == "right" else -1.0


def _cardan(near: FloatArray, far: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """(n,) radians about Z, X and Y of the turn from `near` to `far` (n, 4)."""
    z, x, y = quaternions_to_euler(multiply(conjugate(near), far), "ZXY").T
    return z, x, y


def _joint(
    segments: SegmentFrames, near: str, far: str, inward: float
) -> tuple[FloatArray, FloatArray, FloatArray] | None:
    """(n,) radians of flexion about Z, adduction and internal rotation; None if unknown.

    Where only the direction of the far segment is known, the rotation is NaN: the other two do
    not need it.
    """
    along = _seen_from(segments, near, far)
    if along is None:
        return None
    x, y, z = along.T
    if far in segments.turns:
        _, _, rotation = _cardan(segments.turns[near], segments.turns[far])
    else:
        rotation = np.full(len(x), np.nan)
    return np.arctan2(-x, y), inward * np.arctan2(z, np.hypot(x, y)), inward * rotation


def _seen_from(segments: SegmentFrames, near: str, far: str) -> FloatArray | None:
    """(n, 3) Y of the segment `far` in the frame of `near`; None if one is unknown."""
    axis = _axis(segments, far)
    if axis is None or near not in segments.turns:
        return None
    return rotate(conjugate(segments.turns[near]), axis)


def _axis(segments: SegmentFrames, name: str) -> FloatArray | None:
    """(n, 3) Y of a segment in the world."""
    if name in segments.turns:
        turns = segments.turns[name]
        return rotate(turns, np.broadcast_to(_Y, (len(turns), 3)))
    return segments.axes.get(name)


def _bend(segments: SegmentFrames, near: str, far: str) -> FloatArray | None:
    """(n,) radians, 0 or more, between the directions of two segments."""
    one, other = _axis(segments, near), _axis(segments, far)
    if one is None or other is None:
        return None
    sine = np.linalg.norm(np.cross(one, other), axis=-1)
    return np.asarray(np.arctan2(sine, np.sum(one * other, axis=-1)))


def _raised(along: FloatArray, inward: float) -> tuple[FloatArray, FloatArray]:
    """(n,) the plane of elevation and the elevation of an arm, radians.

    along: (n, 3) from elbow to shoulder in the frame of the thorax.
    """
    x, y, z = along.T
    return np.arctan2(-x, -z * inward), np.arctan2(np.hypot(x, z), y)


def _axial(thorax: FloatArray, arm: FloatArray) -> FloatArray:
    """(n,) the sum of the first and the third angle of the sequence Y-X-Y, radians, for a right
    arm.

    The sum is well defined while the arm hangs, where the two angles are not. It is the rotation
    that is left if the arm is raised without turning it about its length.
    """
    w, _, y, _ = np.moveaxis(multiply(conjugate(thorax), arm), -1, 0)
    return np.asarray(np.arctan2(np.sin(2 * np.arctan2(y, w)), np.cos(2 * np.arctan2(y, w))))
