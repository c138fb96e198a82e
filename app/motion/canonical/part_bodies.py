"""Lower bodies without a trunk, and upper bodies without legs.

The commonest clinical recordings have the markers of pelvis, legs and feet only. They are analyzed
for what they have. The body frame needs a neck and knees, so these are estimated: the neck above
the hips, and the knees below them, at the usual distances. They count as missing.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from app.motion.frame.body_frame import SHIN_PER_TORSO
from app.motion.motion import Motion
from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.recording import Caution
from app.numerics.arrays import FloatArray

_R = JointRole
THIGH_PER_TORSO = 0.245 / 0.29
"""By Drillis and Contini (1966), see `units.py`."""
LOWER_BODY = (_R.HIPS, _R.LEFT_KNEE, _R.RIGHT_KNEE, _R.LEFT_FOOT, _R.RIGHT_FOOT)
"""The roles of a lower body that is analyzed without a neck."""
UPPER_BODY = (
    _R.HIPS, _R.NECK, _R.LEFT_SHOULDER, _R.RIGHT_SHOULDER, _R.LEFT_ELBOW, _R.RIGHT_ELBOW,
)  # fmt: skip
"""The roles of an upper body that is analyzed without knees."""
_KNEES = (_R.LEFT_KNEE, _R.RIGHT_KNEE)
_DOWN = np.array([0.0, -1.0, 0.0])


def is_lower_body(roles: Mapping[JointRole, int]) -> bool:
    """Whether the body has hips and legs, but no neck."""
    return _R.NECK not in roles and all(role in roles for role in LOWER_BODY)


def is_upper_body(roles: Mapping[JointRole, int]) -> bool:
    """Whether the body has hips, trunk and arms, but no knee."""
    has_knee = any(role in roles for role in _KNEES)
    return not has_knee and all(role in roles for role in UPPER_BODY)


def with_estimated_joints(motion: Motion) -> Motion:
    """The motion with the joints that a part of a body lacks, and a caution; else the same.

    motion: in meters, Y up. Its missing roles stay missing.
    """
    if is_lower_body(motion.roles):
        detail = "the neck is estimated above the hips; the arms are missing"
        neck = {_R.NECK: _neck(motion)}
        return _with_joints(motion, neck, Caution("lower_body_only", detail))
    if is_upper_body(motion.roles):
        detail = "the knees are estimated below the hips"
        return _with_joints(motion, _knees(motion), Caution("upper_body_only", detail))
    return motion


def _neck(motion: Motion) -> FloatArray:
    """(frames, 3) the neck of an upright trunk, in meters."""
    shins = [_length(motion, _R(f"{side}_knee"), _R(f"{side}_foot")) for side in ("left", "right")]
    return _at(motion, _R.HIPS) - _DOWN * float(np.mean(shins)) / SHIN_PER_TORSO


def _knees(motion: Motion) -> dict[JointRole, FloatArray]:
    """The knees (frames, 3) of straight legs, in meters."""
    thigh = THIGH_PER_TORSO * _length(motion, _R.HIPS, _R.NECK)
    across = (_at(motion, _R.LEFT_SHOULDER) - _at(motion, _R.RIGHT_SHOULDER)) / 4
    hips = _at(motion, _R.HIPS)
    starts: dict[JointRole, FloatArray] = {
        _R.LEFT_KNEE: hips + across,
        _R.RIGHT_KNEE: hips - across,
    }
    for knee, upper in ((_R.LEFT_KNEE, _R.LEFT_UPPER_LEG), (_R.RIGHT_KNEE, _R.RIGHT_UPPER_LEG)):
        if upper in motion.roles:
            starts[knee] = _at(motion, upper)
    return {knee: start + _DOWN * thigh for knee, start in starts.items()}


def _with_joints(
    motion: Motion, joints: Mapping[JointRole, FloatArray], caution: Caution
) -> Motion:
    count = len(motion.names)
    more = np.stack(list(joints.values()), axis=1).astype(np.float32)
    roles = motion.roles | {role: count + index for index, role in enumerate(joints)}
    return replace(
        motion,
        names=(*motion.names, *(f"estimated_{role.value}" for role in joints)),
        parents=np.concatenate([motion.parents, np.full(len(joints), -1)]),
        positions=np.concatenate([motion.positions, more], axis=1),
        roles={role: roles[role] for role in JointRole if role in roles},
        cautions=(*motion.cautions, caution),
    )


def _at(motion: Motion, role: JointRole) -> FloatArray:
    return motion.positions[:, motion.roles[role]].astype(np.float64)


def _length(motion: Motion, one: JointRole, other: JointRole) -> float:
    return float(np.median(np.linalg.norm(_at(motion, one) - _at(motion, other), axis=1)))
