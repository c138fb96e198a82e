"""The joint centers of a body from its markers.

A file has either markers on the skin or the joints themselves (markerless systems, exports of
skeletons). If most labels of the body are names of joints, the points are the joints. Otherwise
recipes of several markers come first (`joint_centers.py`). Joints that are still missing are made
from others: the hips from both hip joints, the neck from both shoulders, the head from the ears or
the nose.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from app.formats.markers.selection import Markers
from app.motion.roles.joint_centers import Center, joint_centers
from app.motion.roles.joint_names import roles_by_name
from app.motion.roles.joint_roles import JointRole
from app.motion.roles.marker_names import markers_by_place, place_on_body
from app.numerics.arrays import FloatArray

Usable = Mapping[int, FloatArray]
"""The positions (frames, 3) of each marker without long gaps, by its index."""
MIN_NAMED_JOINTS = 8
"""The fewest joints that are named as joints, and not as markers, in a file of joints."""

_R = JointRole
_MIDDLES: tuple[tuple[JointRole, tuple[JointRole, JointRole]], ...] = (
    (_R.HIPS, (_R.LEFT_UPPER_LEG, _R.RIGHT_UPPER_LEG)),
    (_R.NECK, (_R.LEFT_SHOULDER, _R.RIGHT_SHOULDER)),
)
"""Roles whose center is the middle of two others if no marker gives it."""
_HEADS = (("LEFTEAR", "RIGHTEAR"), ("LEAR", "REAR"), ("NOSE",))
"""Labels of points whose mean is the head, the best first."""


def centers_of(markers: Markers, usable: Usable) -> dict[JointRole, Center]:
    """The joint centers by role, from the usable markers."""
    places = markers_by_place(markers.labels)
    tracks = {place: usable[m] for place, m in places.items() if m in usable}
    from_markers = joint_centers(tracks)
    named = _named_joints(markers, usable)
    joints = {role: center for role, center in named.items() if not place_on_body(*center.places)}
    # The first of two equal keys stays, so the better source comes first.
    first = joints if len(joints) >= MIN_NAMED_JOINTS else {}
    centers = {**named, **from_markers, **first}
    _add_middles(centers)
    _add_head(centers, markers, usable)
    return {role: centers[role] for role in JointRole if role in centers}


def _named_joints(markers: Markers, usable: Usable) -> dict[JointRole, Center]:
    """A center for each role whose name is the label of a usable marker."""
    labels = [label if m in usable else "" for m, label in enumerate(markers.labels)]
    return {
        role: Center(usable[marker].astype(np.float64), (labels[marker],))
        for role, marker in roles_by_name(labels).items()
        if marker in usable
    }


def _add_middles(centers: dict[JointRole, Center]) -> None:
    for role, pair in _MIDDLES:
        if role not in centers and all(one in centers for one in pair):
            middle = np.asarray(np.mean([centers[one].positions for one in pair], axis=0))
            centers[role] = Center(middle, sum((centers[one].places for one in pair), ()))


def _add_head(centers: dict[JointRole, Center], markers: Markers, usable: Usable) -> None:
    if _R.HEAD in centers:
        return
    by_label = {_plain(label): m for m, label in enumerate(markers.labels) if m in usable}
    for labels in _HEADS:
        if all(label in by_label for label in labels):
            tracks = [usable[by_label[label]] for label in labels]
            mean = np.mean(tracks, axis=0, dtype=np.float64)
            centers[_R.HEAD] = Center(np.asarray(mean), labels)
            return


def _plain(label: str) -> str:
    return "".join(char for char in label.upper() if char.isalnum())
