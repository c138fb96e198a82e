"""Makes the canonical motion of a recording: meters, Y up, joint roles, frame rate."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from app.errors import BadField, Unreadable
from app.kinedex_error import Place
from app.motion.canonical.extent import check_extent
from app.motion.canonical.frame_rate import judge_frame_rate
from app.motion.canonical.part_bodies import (
    is_lower_body,
    is_upper_body,
    with_estimated_joints,
)
from app.motion.canonical.units import SCALES, Unit, confirm_unit, judge_unit
from app.motion.canonical.up_axis import UP_AXES, judge_up_axis, to_y_up
from app.motion.motion import Motion
from app.motion.plausibility.animals import refuse_animals
from app.motion.plausibility.doubts import doubts_about
from app.motion.roles.bodies import roles_of_one_body
from app.motion.roles.estimated_knees import with_missing_knees
from app.motion.roles.joint_roles import ESSENTIAL_ROLES, SUN_ROLES, JointRole
from app.motion.roles.middles import with_given_middles, with_missing_middles
from app.motion.roles.missing_joints import no_joints_for
from app.motion.roles.roles import given_roles
from app.motion.skeleton.kinematics import rest_positions
from app.motion.skeleton.recording import FRAME_RATES, Caution, Recording
from app.numerics.arrays import FloatArray


def canonicalize(
    recording: Recording,
    *,
    frame_rate: float | None = None,
    metres_per_unit: float | None = None,
    up_axis: str | None = None,
    roles: Mapping[JointRole, str | Sequence[str]]
    | Mapping[str, str | Sequence[str]]
    | None = None,
) -> Motion:
    """The motion of a recording in meters, Y up, right-handed, with roles, rate and unit.

    frame_rate (Hz), metres_per_unit, up_axis and roles (the joint name of each role, or two for
    their middle) are hints of a client. They have priority over the file. Raises BadField if a hint
    is impossible, NotHuman if essential roles are missing or the body is an animal's, Unreadable if
    there is no usable frame rate, and BadContent if the body is larger or faster than any human.
    """
    rate = _active_rate(recording, frame_rate)
    said = {str(role): joints for role, joints in (roles or {}).items()}
    recording, given = with_given_middles(recording, given_roles(recording.skeleton.names, said))
    found, others = roles_of_one_body(
        recording.skeleton.names, recording.skeleton.parents, recording.positions, given
    )
    recording, found, made = with_missing_middles(recording, found)
    recording, found, knees = with_missing_knees(recording, found)
    missing = _missing_roles(found, recording.skeleton.names)
    axis, axis_cautions = _active_up_axis(recording, found, up_axis)
    unit = _active_unit(recording, found, metres_per_unit)
    positions = to_y_up(recording.positions, axis) * np.float32(unit.metres_per_unit)
    motion = Motion(
        format=recording.format,
        names=recording.skeleton.names,
        parents=recording.skeleton.parents,
        positions=np.ascontiguousarray(positions, dtype=np.float32),
        roles=found,
        missing_roles=missing,
        frame_rate=rate,
        declared_frame_rate=recording.frame_rate,
        metres_per_unit=unit.metres_per_unit,
        cautions=recording.cautions + others + made + knees + axis_cautions + unit.cautions,
        start_offset=recording.start_frame / rate,
    )
    if not given and all(role in found for role in ESSENTIAL_ROLES):
        refuse_animals(motion, _rest(recording))
    motion = with_estimated_joints(motion)
    doubts = (
        check_extent(motion)
        + doubts_about(motion, is_rigid=_is_rigid(recording))
        + _roles_caution(missing)
        + _assumption(recording, frame_rate)
        + _rate_cautions(motion)
    )
    return _with_cautions(motion, doubts)


def _rest(recording: Recording) -> FloatArray | None:
    """(joints, 3) the rest pose in the axes of the file; None for markers, which have none."""
    return None if recording.rotations is None else rest_positions(recording.skeleton)


def _is_rigid(recording: Recording) -> bool:
    """Whether the bones have fixed lengths, because only the root moves."""
    return recording.rotations is not None and recording.translations is None


def _active_rate(recording: Recording, hint: float | None) -> float:
    """The frame rate in Hz: from the client, else the file, else the usual one of the format."""
    if hint is not None:
        return _within("frame_rate", hint, FRAME_RATES, "Hz")
    if recording.frame_rate is None and recording.assumed_frame_rate is not None:
        return recording.assumed_frame_rate
    if recording.frame_rate is None:
        reasons = [c.detail for c in recording.cautions if c.code == "frame_time_unusable"]
        message = reasons[0] if reasons else "expected a frame rate, found none"
        raise Unreadable(
            f"The file does not give its frame rate ({message}); send frame_rate",
            places=[Place("frame_rate", message)],
        )
    smallest, largest = FRAME_RATES
    if not smallest <= recording.frame_rate <= largest:
        message = f"expected {smallest:g} to {largest:g} Hz, found {recording.frame_rate:g}"
        raise Unreadable(
            f"The frame rate of the file is impossible ({message}); send frame_rate",
            places=[Place("frame_rate", message)],
        )
    return recording.frame_rate


def _within(field: str, value: float, limits: tuple[float, float], unit: str) -> float:
    if not (math.isfinite(value) and limits[0] <= value <= limits[1]):
        message = f"expected {limits[0]:g} to {limits[1]:g} {unit}, found {value!r}"
        raise BadField(f"{field}: {message}", places=[Place(field, message)])
    return float(value)


def _missing_roles(found: Mapping[JointRole, int], names: Sequence[str]) -> tuple[JointRole, ...]:
    """The roles of SUN_ROLES that were not found.

    Raises NotHuman if one of them is essential, unless the upper or the lower body is there.
    """
    essential = [role for role in ESSENTIAL_ROLES if role not in found]
    if essential and not (is_lower_body(found) or is_upper_body(found)):
        raise no_joints_for(essential, names)
    return tuple(role for role in SUN_ROLES if role not in found)


def _active_up_axis(
    recording: Recording, roles: Mapping[JointRole, int], hint: str | None
) -> tuple[str, tuple[Caution, ...]]:
    """The axis that points up: from the client, else as the file says outright, else judged."""
    if hint is not None:
        if hint not in UP_AXES:
            message = f"expected one of {', '.join(UP_AXES)}, found {hint!r}"
            raise BadField(f"up_axis: {message}", places=[Place("up_axis", message)])
        return hint, ()
    if recording.is_up_axis_said:
        return recording.up_axis, ()
    return judge_up_axis(recording.positions, _rest(recording), roles, recording.up_axis)


def _active_unit(recording: Recording, roles: Mapping[JointRole, int], hint: float | None) -> Unit:
    """The unit from the client, else from the file if it is plausible, else from the stature."""
    if hint is not None:
        return Unit(_within("unit", hint, SCALES, "meters per unit"))
    if recording.metres_per_unit is not None:
        return confirm_unit(recording.metres_per_unit, recording.positions, roles)
    return judge_unit(recording.positions, roles)


def _roles_caution(missing: tuple[JointRole, ...]) -> tuple[Caution, ...]:
    if not missing:
        return ()
    return (Caution("roles_missing", f"no joint was found for: {', '.join(missing)}"),)


def _rate_cautions(motion: Motion) -> tuple[Caution, ...]:
    doubted = ("unit_guessed", "lower_body_only", "upper_body_only")
    is_sure = all(caution.code not in doubted for caution in motion.cautions)
    return tuple(judge_frame_rate(motion.role_positions(), motion.frame_rate, is_unit_sure=is_sure))


def _assumption(recording: Recording, hint: float | None) -> tuple[Caution, ...]:
    """A caution if the frame rate comes neither from the client nor from the file."""
    if hint is not None or recording.frame_rate is not None:
        return ()
    rate = recording.assumed_frame_rate
    detail = f"the file does not give its frame rate; {rate:g} Hz is usual for this format"
    return (Caution("frame_rate_assumed", detail, likely=rate),)


def _with_cautions(motion: Motion, more: tuple[Caution, ...]) -> Motion:
    if not more:
        return motion
    return replace(motion, cautions=motion.cautions + more)
