"""The frames of segments from positions alone: joints of a file without rotations, or markers.

Two joints give the direction of a limb, not its turn about that direction. The thorax has a frame,
from hips, neck and shoulders. The pelvis has one only where its markers are known: the right and
left spine of the ilium in front, and those behind or the sacrum (Wu et al. 2002).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from app.analysis.angles.segment_frames import LIMBS, Neutral, SegmentFrames, turn_of_axes, unit
from app.motion.roles.joint_roles import JointRole
from app.motion.roles.marker_names import places_of
from app.numerics.arrays import FloatArray

_R = JointRole
_BEHIND = (("LPSI", "RPSI"), ("SACR",))


def frames_of_positions(
    positions: FloatArray, names: Sequence[str], roles: Mapping[JointRole, int]
) -> SegmentFrames:
    """The frames and directions of segments that positions determine.

    positions: (n, joints, 3) meters, Y up. names: (joints,). roles: the joint of each role.
    """
    places = positions.astype(np.float64)
    turns = {}
    if _R.LEFT_SHOULDER in roles and _R.RIGHT_SHOULDER in roles:
        spine = places[:, roles[_R.NECK]] - places[:, roles[_R.HIPS]]
        across = places[:, roles[_R.RIGHT_SHOULDER]] - places[:, roles[_R.LEFT_SHOULDER]]
        turns["thorax"] = turn_of_axes(spine, across)
    pelvis = _pelvis(places, places_of(names))
    if pelvis is not None:
        turns["pelvis"] = pelvis
    axes = {
        name: unit(places[:, roles[near]] - places[:, roles[far]])
        for name, (near, far) in LIMBS.items()
        if near in roles and far in roles
    }
    return SegmentFrames(Neutral.POSITIONS, turns, axes)


def _pelvis(places: FloatArray, markers: Mapping[str, int]) -> FloatArray | None:
    """(n, 4) the frame of the pelvis from its markers; None without them.

    Z is the line of the spines in front, X lies in the plane of these and the middle behind.
    """
    behind = next((pair for pair in _BEHIND if all(place in markers for place in pair)), None)
    if behind is None or "LASI" not in markers or "RASI" not in markers:
        return None
    left, right = places[:, markers["LASI"]], places[:, markers["RASI"]]
    back = places[:, [markers[place] for place in behind]].mean(axis=1)
    right_axis = unit(right - left)
    up = np.cross(right_axis, 0.5 * (left + right) - back)
    return turn_of_axes(up, right_axis)
