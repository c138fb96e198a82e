"""The frames of segments from positions alone: joints of a file without rotations, or markers.

Two joints give the direction of a limb, not its turn about that direction. The thorax has a frame,
from hips, neck and shoulders. Other segments have one only where their markers are known (Wu et al.
2002): the pelvis by the spines of the ilium in front, and those behind or the sacrum; the thigh by
both sides of the knee; the shank by both sides of the ankle. Heel and toe give the direction of a
foot, whose sole is taken to be level when both are equally high.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from app.analysis.angles.definitions import SIDES
from app.analysis.angles.segment_frames import LIMBS, Neutral, SegmentFrames, turn_of_axes, unit
from app.motion.motion import Motion
from app.motion.roles.joint_roles import JointRole
from app.motion.roles.marker_names import markers_by_place, subject_and_label
from app.numerics.arrays import FloatArray, IntArray

_R = JointRole
_HEELS = {
    f"{side}{heel}": f"{side}HEE" for side in "LR" for heel in ("HEE", "HEEL", "_HEE", "_HEEL")
}
_BEHIND = (("LPSI", "RPSI"), ("SACR",))


def frames_of_positions(motion: Motion) -> SegmentFrames:
    """The frames and directions of segments that the positions of a motion determine."""
    places, roles = motion.positions.astype(np.float64), motion.roles
    markers = _markers(motion.names, motion.parents)
    turns = _legs(places, markers, roles)
    if _R.LEFT_SHOULDER in roles and _R.RIGHT_SHOULDER in roles:
        spine = places[:, roles[_R.NECK]] - places[:, roles[_R.HIPS]]
        across = places[:, roles[_R.RIGHT_SHOULDER]] - places[:, roles[_R.LEFT_SHOULDER]]
        turns["thorax"] = turn_of_axes(spine, across)
    pelvis = _pelvis(places, markers)
    if pelvis is not None:
        turns["pelvis"] = pelvis
    axes = {
        name: unit(places[:, roles[near]] - places[:, roles[far]])
        for name, (near, far) in LIMBS.items()
        if near in roles and far in roles
    }
    axes |= _feet(places, markers, axes)
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


def _markers(names: Sequence[str], parents: IntArray) -> dict[str, int]:
    """The marker of each place, heels included, without the subject before a colon.

    Joints of a skeleton are no markers, although some are called alike.
    """
    loose = (parents < 0) & ~np.isin(np.arange(len(parents)), parents)
    labels = [
        subject_and_label(name)[1] if free else "" for name, free in zip(names, loose, strict=True)
    ]
    heels = {
        _HEELS[label.upper()]: marker
        for marker, label in enumerate(labels)
        if label.upper() in _HEELS
    }
    return markers_by_place(labels) | heels


def _legs(
    places: FloatArray, markers: Mapping[str, int], roles: Mapping[JointRole, int]
) -> dict[str, FloatArray]:
    """(n, 4) the frames of thighs and shanks whose far joint has markers on both sides."""
    found = {}
    for side in SIDES:
        for part, outer, inner in (("thigh", "KNE", "KNM"), ("shank", "ANK", "ANM")):
            pair = [f"{side[0].upper()}{place}" for place in (outer, inner)]
            ends = LIMBS[f"{side}_{part}"]
            if all(place in markers for place in pair) and all(joint in roles for joint in ends):
                near, far = (places[:, roles[joint]] for joint in ends)
                outward = places[:, markers[pair[0]]] - places[:, markers[pair[1]]]
                right = outward if side == "right" else -outward
                found[f"{side}_{part}"] = turn_of_axes(near - far, right)
    return found


def _feet(
    places: FloatArray, markers: Mapping[str, int], axes: Mapping[str, FloatArray]
) -> dict[str, FloatArray]:
    """(n, 3) Y of feet with heel and toe: at right angles to their line, nearest to the shank."""
    found = {}
    for side in SIDES:
        heel, toe = (f"{side[0].upper()}{place}" for place in ("HEE", "TOE"))
        shank = axes.get(f"{side}_shank")
        if heel in markers and toe in markers and shank is not None:
            ahead = unit(places[:, markers[toe]] - places[:, markers[heel]])
            away = shank - ahead * np.sum(shank * ahead, axis=-1, keepdims=True)
            found[f"{side}_foot"] = unit(away)
    return found
