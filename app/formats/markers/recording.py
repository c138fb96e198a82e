"""Makes a recording of labeled markers.

The first joints of the recording are joint centers that are computed from the markers. They are a
tree with plain names. Then come the markers, under their labels and without parents, so that a
client may choose them as roles. Left out are points without a label, results of gait models,
other subjects, and markers that are seen too rarely. Cautions name the last two.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from app.formats.common.failures import too_large
from app.formats.common.limits import MAX_JOINTS
from app.formats.markers.centers import Usable, centers_of
from app.formats.markers.rigid_gaps import fill_by_neighbors
from app.formats.markers.selection import (
    Markers,
    gap_cautions,
    labeled_markers,
    stretch_caution,
)
from app.formats.markers.stretches import readable_stretch
from app.formats.markers.tracks import Tracks
from app.motion.roles.joint_centers import Center
from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.occlusion import fill_gaps
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


def recording_of_markers(tracks: Tracks, format: str) -> Recording:
    """A recording of joint centers and markers, in the unit and axes of the file.

    format: the name of the file's format. Raises Unreadable with the marker and its frames if a
    marker that a joint needs is hidden for too long, and TooLarge for more than MAX_JOINTS markers.
    """
    markers = labeled_markers(tracks)
    if len(markers.labels) > MAX_JOINTS:
        raise too_large("labels", f"expected at most {MAX_JOINTS} labeled markers")
    rate = tracks.frame_rate or RATE_FOR_GAPS
    filled = _filled(markers, rate)
    stretch = readable_stretch(markers, filled, rate)
    positions = filled[stretch]
    good = np.isfinite(positions[..., 0]).all(axis=0)
    usable = {marker: positions[:, marker] for marker in np.flatnonzero(good).tolist()}
    centers = centers_of(markers, usable)
    cautions = stretch_caution(markers, stretch) + gap_cautions(markers, stretch, positions)
    skeleton, positions = _skeleton(markers.labels, usable, centers)
    return Recording(
        format=format,
        skeleton=skeleton,
        positions=positions,
        rotations=None,
        translations=None,
        frame_rate=tracks.frame_rate,
        up_axis=tracks.up_axis,
        metres_per_unit=tracks.metres_per_unit,
        start_frame=markers.skipped + stretch.start,
        cautions=tracks.cautions + markers.cautions + cautions,
    )


def _filled(markers: Markers, rate: float) -> FloatArray:
    """(frames, markers, 3) short gaps are filled by splines, and long ones by their neighbors."""
    filled = fill_gaps(markers.positions, rate)
    return fill_by_neighbors(markers.labels, filled.positions, filled.long_gaps, rate)


def _skeleton(
    labels: Sequence[str], usable: Usable, centers: Mapping[JointRole, Center]
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
