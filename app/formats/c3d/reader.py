"""Reads C3D files of labeled markers: bytes in, Recording out.

The first joints of the recording are joint centers that are computed from the markers. They are a
tree with plain names. Then come the markers, under their labels and without parents, so that a
client may choose them as roles. Left out are points without a label, results of gait models,
other subjects, and markers that are seen too rarely. Cautions name the last two.

We have our own reader because ezc3d 1.7 crashes, hangs or needs gigabytes for one broken file in
twenty, and reads a truncated file as one frame. The tests compare our reader with ezc3d.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from app.formats.c3d.markers import Markers, gap_cautions, hidden_too_long, labeled_markers
from app.formats.c3d.points import Points, read_points
from app.motion.canonical.units import METERS_PER_UNIT
from app.motion.roles.joint_centers import RECIPES, Center, best_recipe, joint_centers
from app.motion.roles.joint_names import roles_by_name
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.motion.roles.marker_names import markers_by_place
from app.motion.skeleton.occlusion import Gap, fill_gaps
from app.motion.skeleton.recording import Recording
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray

RATE_FOR_GAPS = 100.0
"""Hz: the rate that converts gaps to seconds if the file does not give its rate."""

_R = JointRole
_PARENTS: dict[JointRole, JointRole] = {
    _R.NECK: _R.CHEST,
    _R.LEFT_KNEE: _R.LEFT_UPPER_LEG,
    _R.RIGHT_KNEE: _R.RIGHT_UPPER_LEG,
}
"""Parents in the tree of joint centers that are not the role's neighbor toward the trunk."""
_NAMES: dict[str, str] = {
    "upper_leg": "UpLeg", "knee": "Knee", "foot": "Ankle", "toes": "ToeBase",
    "shoulder": "UpperArm", "elbow": "Elbow", "hand": "Wrist",
}  # fmt: skip
_UNITS = {"millimeter": "mm", "centimeter": "cm", "meter": "m", "inch": "in", "foot": "ft"}


def read_c3d(content: bytes) -> Recording:
    """Read a C3D file.

    Units and axes are those of the file. Raises Unreadable with the byte; Unreadable with the
    marker and its frames if a marker that a joint needs is hidden for too long; and TooLarge.
    """
    points = read_points(content)
    markers = labeled_markers(points)
    filled = fill_gaps(markers.positions, points.frame_rate or RATE_FOR_GAPS)
    good = np.isfinite(filled.positions).all(axis=(0, 2))
    usable = {marker: filled.positions[:, marker] for marker in np.flatnonzero(good).tolist()}
    centers = _centers(markers, usable, filled.long_gaps)
    skeleton, positions = _skeleton(markers.labels, usable, centers)
    return Recording(
        format="c3d",
        skeleton=skeleton,
        positions=positions,
        rotations=None,
        translations=None,
        frame_rate=points.frame_rate,
        up_axis=_up_axis(points),
        metres_per_unit=_metres_per_unit(points),
        cautions=points.cautions
        + markers.cautions
        + gap_cautions(markers, filled.frames, filled.long_gaps),
    )


def _centers(
    markers: Markers, usable: Mapping[int, FloatArray], gaps: Sequence[Gap]
) -> dict[JointRole, Center]:
    """The joint centers by role, from recipes of several markers, else from a marker's label.

    usable: (frames, 3) for each marker without long gaps. Raises Unreadable if one of Sun's roles
    cannot be computed because of long gaps.
    """
    places = markers_by_place(markers.labels)
    tracks = {place: usable[m] for place, m in places.items() if m in usable}
    centers = joint_centers(tracks)
    for role, center in _centers_by_label(markers, usable).items():
        centers.setdefault(role, center)
    for role in SUN_ROLES:
        recipe = None if role in centers else best_recipe(RECIPES[role], places.__contains__)
        if recipe is not None:
            hidden = {places[place] for place in recipe}
            raise hidden_too_long(markers, [gap for gap in gaps if gap.marker in hidden])
    return centers


def _centers_by_label(
    markers: Markers, usable: Mapping[int, FloatArray]
) -> dict[JointRole, Center]:
    """A center for each role whose name is the label of a usable marker."""
    labels = [label if m in usable else "" for m, label in enumerate(markers.labels)]
    return {
        role: Center(usable[marker].astype(np.float64), (labels[marker],))
        for role, marker in roles_by_name(labels).items()
        if marker in usable
    }


def _skeleton(
    labels: Sequence[str],
    usable: Mapping[int, FloatArray],
    centers: Mapping[JointRole, Center],
) -> tuple[Skeleton, FloatArray]:
    """The skeleton of joint centers and single markers; positions (frames, joints, 3) float32.

    labels: (markers,). The rest pose has the median positions.
    """
    roles = _in_tree_order(centers)
    names = [_name(role) for role in roles]
    above = [_parent_role(role, centers) for role in roles]
    parents = [-1 if parent is None else roles.index(parent) for parent in above]
    single = [marker for marker in usable if labels[marker] not in names]
    tracks = [centers[role].positions for role in roles] + [usable[marker] for marker in single]
    positions = np.stack(tracks, axis=1).astype(np.float32)
    parents_of = np.array(parents + [-1] * len(single), dtype=np.int64)
    middle = np.median(positions, axis=0).astype(np.float64)
    offsets = np.where(parents_of[:, None] < 0, middle, middle - middle[parents_of])
    names += [labels[marker] for marker in single]
    return Skeleton(tuple(names), parents_of, offsets), positions


def _in_tree_order(centers: Mapping[JointRole, Center]) -> list[JointRole]:
    depth: dict[JointRole, int] = {}
    for role in centers:
        above, steps = role, 0
        while (next_above := _parent_role(above, centers)) is not None:
            above, steps = next_above, steps + 1
        depth[role] = steps
    return sorted(centers, key=depth.__getitem__)


def _parent_role(role: JointRole, centers: Mapping[JointRole, Center]) -> JointRole | None:
    """The nearest role toward the hips that has a center; None if there is none."""
    while role is not _R.HIPS:
        role = _PARENTS.get(role, role.toward_trunk())
        if role in centers:
            return role
    return None


def _name(role: JointRole) -> str:
    side, _, part = role.partition("_")
    return f"{side.title()}{_NAMES[part]}" if part else role.title()


def _metres_per_unit(points: Points) -> float | None:
    units = points.parameters.get("POINT:UNITS")
    name = units.texts[0].strip().lower() if units is not None and units.texts else ""
    spelled = name.replace("metre", "meter").rstrip("s")
    return METERS_PER_UNIT.get(_UNITS.get(spelled, name))


def _up_axis(points: Points) -> str:
    """The axis that points up on a screen; Z, which is usual, if the file does not give it."""
    screen = points.parameters.get("POINT:Y_SCREEN")
    axis = screen.texts[0].strip().lower()[-1:] if screen is not None and screen.texts else ""
    return axis if axis in ("x", "y", "z") and axis else "z"
