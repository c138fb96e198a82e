"""Finds the part of a recording in which the markers that a body needs are known.

If a marker is hidden for so long that it cannot be filled in, either the longest stretch without
such gaps is read, or the roles that need the marker are left out. Roles without which there is no
body frame are never left out.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from app.formats.markers.selection import Markers, hidden_too_long
from app.motion.roles.joint_centers import RECIPES, best_recipe, joint_centers
from app.motion.roles.joint_names import roles_by_name
from app.motion.roles.joint_roles import ESSENTIAL_ROLES, SUN_ROLES, JointRole
from app.motion.roles.marker_names import markers_by_place
from app.motion.skeleton.occlusion import Gap, runs
from app.numerics.arrays import BoolArray, FloatArray

MIN_SECONDS = 0.5
"""The shortest stretch that is read in place of the whole recording."""
MIN_SHARE = 0.7
"""The least share of the recording that a stretch must have, so that no role is left out."""


def readable_stretch(markers: Markers, positions: FloatArray, frame_rate: float) -> slice:
    """The frames to read.

    positions: (frames, markers, 3), NaN in gaps that were not filled. Raises Unreadable with the
    markers and their frames if no stretch is long enough.
    """
    known: BoolArray = np.asarray(np.isfinite(positions[..., 0]))
    blocked = {} if known.all() else _blocked_roles(markers.labels, known)
    if not blocked:
        return slice(0, len(known))
    every = _longest(known, [marker for hidden in blocked.values() for marker in hidden])
    if _length(every) >= max(MIN_SHARE * len(known), MIN_SECONDS * frame_rate):
        return every
    essential = [marker for role in ESSENTIAL_ROLES for marker in blocked.get(role, ())]
    if not essential:
        return slice(0, len(known))
    stretch = _longest(known, essential)
    if _length(stretch) < MIN_SECONDS * frame_rate:
        raise hidden_too_long(markers, list(_gaps(known, essential)))
    return stretch


def _blocked_roles(labels: Sequence[str], known: BoolArray) -> dict[JointRole, list[int]]:
    """The hidden markers of each of Sun's roles that cannot be computed in all frames."""
    places = markers_by_place(labels)
    whole: BoolArray = np.asarray(known.all(axis=0))
    usable = {place: np.zeros((1, 3)) for place, marker in places.items() if whole[marker]}
    found = set(joint_centers(usable))
    found |= set(
        roles_by_name([label if ok else "" for label, ok in zip(labels, whole, strict=True)])
    )
    blocked = {}
    by_name = roles_by_name(labels)
    for role in SUN_ROLES:
        if role in found:
            continue
        recipe = best_recipe(RECIPES[role], places.__contains__)
        used = [places[place] for place in recipe] if recipe else [by_name.get(role, -1)]
        hidden = [marker for marker in used if marker >= 0 and not whole[marker]]
        if hidden:
            blocked[role] = hidden
    return blocked


def _longest(known: BoolArray, markers: Iterable[int]) -> slice:
    """The longest run of frames in which all markers are known."""
    all_known: BoolArray = np.asarray(known[:, list(markers)].all(axis=1))
    longest = max(runs(all_known), key=lambda run: run[1] - run[0], default=[0, 0])
    return slice(longest[0], longest[1])


def _length(stretch: slice) -> int:
    return int(stretch.stop - stretch.start)


def _gaps(known: BoolArray, markers: Iterable[int]) -> Iterable[Gap]:
    for marker in dict.fromkeys(markers):
        for start, end in runs(~known[:, marker]):
            yield Gap(marker, start, end)
