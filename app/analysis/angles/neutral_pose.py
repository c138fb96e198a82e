"""The frames of segments from a file's rotations, calibrated by a neutral pose.

Rotations of a file belong to its joints' own axes, which mean nothing for anatomy. A neutral pose
relates them to the segments, as a static trial does in a gait laboratory. The best one is the
file's rest pose (all rotations 0) if it is a standing person. Other files have a rest pose with all
bones in one line (Bandai-Namco). There the most upright frame of the clip is the neutral pose, and
knees and elbows bend about the mean axis of their motion.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from app.analysis.angles.segment_frames import (
    LIMBS,
    Neutral,
    SegmentFrames,
    limb_turn,
    turn_of_axes,
    unit,
)
from app.deadline import check
from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.animation import Animation
from app.motion.skeleton.kinematics import joints_by_depth, rest_positions
from app.motion.skeleton.rotations import conjugate, identity_quaternions, multiply, rotate
from app.numerics.arrays import FloatArray

MAX_LEAN = np.radians(35.0)
"""Radians: in a rest pose of a standing person, trunk and legs lean at most so far."""

MIN_BEND = np.radians(20.0)
"""Radians: the motion shows the axis of a knee or elbow only if it bends more than this."""

FLAT_SHARE = 0.05
"""The share of frames, those in which ankle and toes are lowest, in which a foot stands flat."""

_R = JointRole
_UP = np.array([0.0, 1.0, 0.0])
_Roles = Mapping[JointRole, int]
_HINGES = (("thigh", "shank", -1.0), ("upper_arm", "forearm", 1.0))
"""Near and far segment, and the sign with which the turn from near to far points to the right."""


@dataclass(frozen=True, slots=True)
class _Pose:
    """places: (joints, 3) meters. turns: (joints, 4) world rotations of the joints."""

    places: FloatArray
    turns: FloatArray


@dataclass(frozen=True, slots=True)
class _Track:
    """The same as a pose for all frames: (n, joints, 3) and (n, joints, 4)."""

    places: FloatArray
    turns: FloatArray


def frames_of_rotations(animation: Animation, roles: _Roles) -> SegmentFrames:
    """The frames of all segments whose joints are known.

    animation: with the rotations of the file. roles: the joint of each role.
    """
    track = _Track(animation.positions(), world_rotations(animation))
    rest = _Pose(
        rest_positions(animation.skeleton), identity_quaternions((len(animation.skeleton),))
    )
    joints = _joints(animation, roles)
    if _is_standing(rest.places, roles):
        pose, neutral = rest, Neutral.REST_POSE
    else:
        frame = _most_upright(track.places, roles)
        pose = _Pose(track.places[frame], track.turns[frame])
        neutral = Neutral.UPRIGHT_POSE
    local = {
        name: multiply(conjugate(pose.turns[joints[name]]), turn)
        for name, turn in _neutral_turns(pose, roles, neutral).items()
        if name in joints
    }
    if neutral is Neutral.UPRIGHT_POSE:
        local |= _hinges(track, roles) | _flat_feet(track, roles)
    turns = {name: multiply(track.turns[:, joints[name]], turn) for name, turn in local.items()}
    return SegmentFrames(neutral, turns)


def world_rotations(animation: Animation) -> FloatArray:
    """(n, joints, 4) the rotations of the joints in the world."""
    turns = np.array(animation.rotations, dtype=np.float64)
    for joints in joints_by_depth(animation.skeleton.parents)[1:]:
        check()
        above = turns[:, animation.skeleton.parents[joints]]
        turns[:, joints] = multiply(above, turns[:, joints])
    return turns


def _joints(animation: Animation, roles: _Roles) -> dict[str, int]:
    """The joint that turns each segment."""
    found = {name: roles[near] for name, (near, _) in LIMBS.items() if near in roles}
    found |= {f"{s}_foot": roles[r] for s, r in _FEET.items() if r in roles}
    found["pelvis"] = roles[_R.HIPS]
    found["thorax"] = max(0, int(animation.skeleton.parents[roles[_R.NECK]]))
    return found


_FEET = {"left": _R.LEFT_FOOT, "right": _R.RIGHT_FOOT}


def _is_standing(places: FloatArray, roles: _Roles) -> bool:
    """Whether trunk and legs of the pose `places` (joints, 3) are upright, with hips apart."""
    if _R.LEFT_UPPER_LEG not in roles or _R.RIGHT_UPPER_LEG not in roles:
        return False
    bones = [(_R.HIPS, _R.NECK)]
    bones += [LIMBS[f"{s}_{part}"][::-1] for s in ("left", "right") for part in ("thigh", "shank")]
    upright = [
        _angle(places[roles[high]] - places[roles[low]], _UP) < MAX_LEAN
        for low, high in bones
        if low in roles and high in roles
    ]
    across = places[roles[_R.RIGHT_UPPER_LEG]] - places[roles[_R.LEFT_UPPER_LEG]]
    return bool(all(upright) and abs(_angle(across, _UP) - np.pi / 2) < MAX_LEAN)


def _angle(one: FloatArray, other: FloatArray) -> FloatArray:
    """(...,) radians between vectors (..., 3); NaN, which is never small, without a length."""
    a, b = np.broadcast_arrays(unit(one), unit(other))
    sine = np.linalg.norm(np.cross(a, b), axis=-1)
    return np.asarray(np.arctan2(sine, np.sum(a * b, axis=-1)))


def _most_upright(places: FloatArray, roles: _Roles) -> int:
    """The frame with the least lean of the trunk plus mean bend of the knees."""
    score = _angle(places[:, roles[_R.NECK]] - places[:, roles[_R.HIPS]], _UP)
    for side in ("left", "right"):
        if _has(roles, side, "thigh", "shank"):
            score = score + 0.5 * _angle(*(_limb(places, roles, f"{side}_{p}") for p in _LEG))
    return int(np.argmin(np.nan_to_num(score, nan=np.inf)))


_LEG = ("thigh", "shank")


def _has(roles: _Roles, side: str, *parts: str) -> bool:
    return all(joint in roles for part in parts for joint in LIMBS[f"{side}_{part}"])


def _limb(places: FloatArray, roles: _Roles, name: str) -> FloatArray:
    """(..., 3) from the near to the far joint of a limb."""
    near, far = LIMBS[name]
    return np.asarray(places[..., roles[far], :] - places[..., roles[near], :], dtype=np.float64)


def _neutral_turns(pose: _Pose, roles: _Roles, neutral: Neutral) -> dict[str, FloatArray]:
    """(4,) the frames of the segments in the neutral pose."""
    body = turn_of_axes(_UP, _right(pose.places, roles))
    spine = pose.places[roles[_R.NECK]] - pose.places[roles[_R.HIPS]]
    found = {"pelvis": body, "thorax": body, "left_foot": body, "right_foot": body}
    if neutral is Neutral.UPRIGHT_POSE:
        # the pelvis may lean to a side in that frame: level is the line of the hips
        right = unit(_right(pose.places, roles))
        found["pelvis"] = turn_of_axes(_UP - (_UP @ right) * right, right)
        found["thorax"] = turn_of_axes(spine, _right(pose.places, roles, _SHOULDERS))
    for name, (near, far) in LIMBS.items():
        if near in roles and far in roles:
            found[name] = limb_turn(body, _limb(pose.places, roles, name))
    for side in _FEET:
        if _has(roles, side, "shank"):
            found[f"{side}_foot"] = _foot_turn(body, _limb(pose.places, roles, f"{side}_shank"))
    return {name: turn for name, turn in found.items() if np.isfinite(turn).all()}


def _foot_turn(body: FloatArray, shank: FloatArray) -> FloatArray:
    """(4,) the frame of a foot whose sole is level, but at right angles to the leg from side to
    side.

    shank: (3,) from knee to ankle. The legs of CMU's rest pose are spread by 20 degrees, and the
    feet lean with them.
    """
    right = rotate(body, np.array([0.0, 0.0, 1.0]))
    ahead = np.cross(_UP, right)
    up = -shank + ahead * (shank @ unit(ahead))
    return turn_of_axes(up, np.cross(ahead, up))


_SHOULDERS = (_R.LEFT_SHOULDER, _R.RIGHT_SHOULDER)
_HIPS = (_R.LEFT_UPPER_LEG, _R.RIGHT_UPPER_LEG)
_KNEES = (_R.LEFT_KNEE, _R.RIGHT_KNEE)


def _right(
    places: FloatArray, roles: _Roles, first: tuple[JointRole, JointRole] = _HIPS
) -> FloatArray:
    """(3,) from the left to the right joint of the first pair that is there."""
    pairs = (first, _HIPS, _SHOULDERS, _KNEES)
    left, right = next(pair for pair in pairs if all(role in roles for role in pair))
    return np.asarray(places[roles[right]] - places[roles[left]])


def _hinges(track: _Track, roles: _Roles) -> dict[str, FloatArray]:
    """(4,) frames of limbs in the axes of their joints, by the mean axis of knee or elbow."""
    found = {}
    for side in ("left", "right"):
        for near, far, sign in _HINGES:
            if not _has(roles, side, near, far):
                continue
            names = (f"{side}_{near}", f"{side}_{far}")
            one, other = (unit(_limb(track.places, roles, name)) for name in names)
            if np.nanpercentile(_angle(one, other), 95) < MIN_BEND:
                continue
            # long where the joint is bent: such frames count more
            axes = sign * np.cross(one, other)
            for name, along in zip(names, (one, other), strict=True):
                back = conjugate(track.turns[:, roles[LIMBS[name][0]]])
                hinge = np.nanmean(rotate(back, axes), axis=0)
                found[name] = turn_of_axes(-np.nanmean(rotate(back, along), axis=0), hinge)
    return {name: turn for name, turn in found.items() if np.isfinite(turn).all()}


def _flat_feet(track: _Track, roles: _Roles) -> dict[str, FloatArray]:
    """(4,) frames of feet in the axes of their joints: Y is up while the foot stands flat."""
    found = {}
    for side, foot in _FEET.items():
        toes = JointRole(f"{side}_toes")
        if foot not in roles or toes not in roles:
            continue
        ends = track.places[:, [roles[foot], roles[toes]]]
        heights = ends[..., 1] - np.percentile(ends[..., 1], 100 * FLAT_SHARE, axis=0)
        lowest = np.argsort(heights.max(axis=1), kind="stable")
        flat = lowest[: max(1, round(FLAT_SHARE * len(lowest)))]
        back = conjugate(track.turns[flat, roles[foot]])
        up = rotate(back, np.broadcast_to(_UP, (len(flat), 3))).mean(axis=0)
        ahead = rotate(back, ends[flat, 1] - ends[flat, 0]).mean(axis=0)
        found[f"{side}_foot"] = turn_of_axes(up, np.cross(ahead, up))
    return {name: turn for name, turn in found.items() if np.isfinite(turn).all()}
