"""Estimates knees from hip joints, ankles and toes, where a marker set has none.

Many marker sets have groups of markers on thigh and shank in place of markers on the knee. Thigh
and shank are equally long (.245 and .246 of the stature by Drillis and Contini 1966), and the leg
is straight at least once in a recording. So the knee of a bent leg lies on a circle about the line
from hip to ankle, on the side to which the toes point.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from app.motion.roles.added_joints import with_joints
from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.recording import Caution, Recording
from app.numerics.arrays import FloatArray

STRAIGHT_QUANTILE = 98.0
"""Percent: this quantile of the distance from hip to ankle is the length of the straight leg."""
MIN_LENGTH = 1e-9
_R = JointRole
_KNEES = (_R.LEFT_KNEE, _R.RIGHT_KNEE)


def with_missing_knees(
    recording: Recording, found: Mapping[JointRole, int]
) -> tuple[Recording, dict[JointRole, int], tuple[Caution, ...]]:
    """The recording with knees that were not found, if hip joints, feet and toes were.

    found: the joint of each role.
    """
    missing = [knee for knee in _KNEES if knee not in found]
    needed = {_R(_part(knee, part)) for knee in missing for part in ("upper_leg", "foot", "toes")}
    if not missing or not needed <= found.keys():
        return recording, dict(found), ()
    tracks = {knee: _knee(recording.positions, found, knee) for knee in missing}
    recording, made = with_joints(recording, tracks, "estimated")
    roles = dict(found) | made
    names = [recording.skeleton.names[joint] for joint in made.values()]
    detail = f"knees were estimated from hip joints, ankles and toes: {', '.join(names)}"
    ordered = {role: roles[role] for role in JointRole if role in roles}
    return recording, ordered, (Caution("knees_estimated", detail, joint=names[0]),)


def _part(knee: JointRole, part: str) -> str:
    """The role of another part of the same leg."""
    return knee.replace("knee", part)


def _knee(positions: FloatArray, found: Mapping[JointRole, int], knee: JointRole) -> FloatArray:
    """(frames, 3) the knee, in the unit and axes of the positions (frames, joints, 3)."""
    hip, ankle, toes = (
        positions[:, found[_R(_part(knee, part))]].astype(np.float64)
        for part in ("upper_leg", "foot", "toes")
    )
    leg = ankle - hip
    length = np.linalg.norm(leg, axis=1)
    straight = float(np.percentile(length, STRAIGHT_QUANTILE))
    down = leg / np.maximum(length, MIN_LENGTH)[:, None]
    forward = toes - ankle
    forward -= np.einsum("fc,fc->f", forward, down)[:, None] * down
    forward /= np.maximum(np.linalg.norm(forward, axis=1), MIN_LENGTH)[:, None]
    bend = np.sqrt(np.maximum(straight**2 - length**2, 0.0)) / 2
    return np.asarray((hip + ankle) / 2 + bend[:, None] * forward)
