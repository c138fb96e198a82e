"""Exports a ready clip as a file for other programs: BVH, GLB, NPZ, CSV, C3D or TRC.

BVH and GLB need rotations. If the clip's file has rotations, a child process reads it again, and
they are rotated and scaled like the clip. If the file has none, or if it no longer gives the stored
positions, they are solved from the positions. Joints with bones of variable length get
translations; the positions are restored within 0.1 mm.

A motion reduced to few dimensions has the 13 joint roles and rotations solved from their positions.
Its bones have variable lengths, except on the canonical body.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.formats.bvh.export import write_animation_bvh
from app.formats.c3d.writer import write_c3d
from app.formats.csv.writer import axis_columns, csv_tracks
from app.formats.gltf.writer import write_glb
from app.formats.npz.writer import write_npz
from app.formats.trc.writer import write_trc
from app.motion.frame.body_frame import ANALYSIS_RATE
from app.motion.motion import Motion
from app.motion.posing.canonical_body import on_canonical_body
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.motion.skeleton.animation import Animation
from app.numerics.arrays import FloatArray, IntArray
from app.services.library.library import Library
from app.services.library.ready_clips import ready_clip
from app.services.library.stored_motion import load_motion
from app.services.views.clip_parts import Part, part_of_animation, part_of_motion
from app.services.views.clip_rotations import own_animation, resampled, solved_animation
from app.services.views.export_format import (
    ExportContent,
    ExportFormat,
    ExportJoints,
    ExportSkeleton,
    ExportUnit,
)
from app.services.views.export_options import ExportOptions, checked_options
from app.services.views.exported import Export
from app.services.views.frame_rates import requested_rate
from app.services.views.low_dimensional import Reduction, as_motion, reduce
from app.services.views.tables import table_of
from app.store.clips import license_policy
from app.store.clips.record import ClipRecord


@dataclass(frozen=True, slots=True)
class _Positions:
    names: Sequence[str]
    parents: IntArray
    positions: FloatArray
    frame_rate: float


def export(
    lib: Library,
    clip_id: str,
    format: ExportFormat | str,
    *,
    content: ExportContent | str | None = None,
    unit: ExportUnit | str | None = None,
    joints: ExportJoints | str = ExportJoints.ALL,
    skeleton: ExportSkeleton | str = ExportSkeleton.OWN,
    fps: float | None = None,
    reduction: Reduction | None = None,
    part: Part | None = None,
) -> Export:
    """A clip as a file of `format`, resampled by time to `fps` (default: its own rate).

    content: the table of a CSV file (default: positions). unit: of lengths (default: that of the
    format). joints: all, or those with a role, by role. reduction: reduce the motion to few
    dimensions, on the 13 joint roles, by default at 30 Hz. part: only these seconds of the clip.

    Raises BadField, ClipNotFound, ClipNotReady, LicenseNotAllowed, NotEnoughKeyposes, NoGait.
    """
    options = checked_options(
        format,
        content=content,
        unit=unit,
        joints=joints,
        skeleton=skeleton,
        fps=fps,
        reduction=reduction,
        part=part,
    )
    clip = ready_clip(lib, clip_id)
    license_policy.check(clip.license)
    if options.content is not ExportContent.POSITIONS:
        own_rate, joint_count = clip.frame_rate or 1.0, clip.joints or 0
        rate = requested_rate(lib, clip, fps, source=own_rate, joints=joint_count)
        table = table_of(lib, clip, options.content, rate)
        return Export(f"{_safe_stem(clip)}-{options.content}.csv", table)
    motion, rate, ending = _motion(lib, clip, options)
    name = f"{_safe_stem(clip)}{ending}.{options.format.value}"
    return Export(name, _blocks(lib, clip, options, motion, rate, name))


def _motion(lib: Library, clip: ClipRecord, options: ExportOptions) -> tuple[Motion, float, str]:
    """The motion, the requested rate, and the ending of the file name."""
    reduction = options.reduction
    source = clip.frame_rate or 1.0 if reduction is None else ANALYSIS_RATE
    joints = clip.joints or 0 if reduction is None else len(SUN_ROLES)
    rate = requested_rate(lib, clip, options.fps, source=source, joints=joints)
    ending = "-canonical" if options.skeleton is ExportSkeleton.CANONICAL else ""
    if reduction is None:
        return load_motion(lib, clip), rate, ending
    found = reduce(lib, clip, reduction)
    return as_motion(found, clip), rate, f"-{found.basis.value}-{found.dimensions}dim{ending}"


def _blocks(
    lib: Library, clip: ClipRecord, options: ExportOptions, motion: Motion, rate: float, name: str
) -> Iterable[bytes]:
    whole, motion = motion, part_of_motion(motion, options.part)
    if options.skeleton is ExportSkeleton.CANONICAL:
        animation = on_canonical_body(resampled(motion, rate))
        return _of_animation(options, animation, clip, name)
    if options.format not in (ExportFormat.BVH, ExportFormat.GLB):
        motion = resampled(motion, rate)
        if options.joints is ExportJoints.ROLES:
            motion = _by_role(motion)
        tracks = _Positions(motion.names, motion.parents, motion.positions, rate)
        return _of_positions(options, tracks, name)
    if options.reduction is None:
        own = own_animation(lib, clip, whole, rate)
        return _of_animation(options, part_of_animation(own, options.part), clip, name)
    return _of_animation(options, solved_animation(motion, rate), clip, name)


def _by_role(motion: Motion) -> Motion:
    """The joints of which the role is known, named by role."""
    roles = [role for role in JointRole if role in motion.roles]
    above = [_above(role, roles) for role in roles]
    parents = [-1 if role is None else roles.index(role) for role in above]
    return replace(
        motion,
        names=tuple(role.value for role in roles),
        parents=np.array(parents),
        positions=motion.positions[:, [motion.roles[role] for role in roles]],
        roles={role: joint for joint, role in enumerate(roles)},
    )


def _above(role: JointRole, roles: Sequence[JointRole]) -> JointRole | None:
    """The nearest of `roles` toward the trunk."""
    while role is not role.toward_trunk():
        role = role.toward_trunk()
        if role in roles:
            return role
    return None


def _of_animation(
    options: ExportOptions, animation: Animation, clip: ClipRecord, name: str
) -> Iterable[bytes]:
    if options.format is ExportFormat.BVH:
        return write_animation_bvh(animation, options.units_per_meter)
    if options.format is ExportFormat.GLB:
        return [write_glb(animation, clip.name, clip.license)]
    skeleton = animation.skeleton
    positions = animation.positions().astype(np.float32)
    tracks = _Positions(skeleton.names, skeleton.parents, positions, animation.frame_rate)
    return _of_positions(options, tracks, name)


def _of_positions(options: ExportOptions, tracks: _Positions, name: str) -> Iterable[bytes]:
    unit, scale = options.unit.value, options.units_per_meter
    names, positions, rate = tracks.names, tracks.positions, tracks.frame_rate
    if options.format is ExportFormat.NPZ:
        return [write_npz(names, tracks.parents, positions, rate)]
    if options.format is ExportFormat.C3D:
        return write_c3d(names, positions, rate, unit=unit, units_per_meter=scale)
    if options.format is ExportFormat.TRC:
        return write_trc(names, positions, rate, unit=unit, units_per_meter=scale, file_name=name)
    flat = positions.reshape(len(positions), -1)
    return csv_tracks(axis_columns(names, unit), flat if scale == 1 else flat * scale, rate)


def _safe_stem(clip: ClipRecord) -> str:
    """The clip's name as a file name that is valid on all systems."""
    safe = "".join(c if c.isalnum() or c in " ._-()+" else "_" for c in clip.name)
    return safe.strip(" ._")[:100] or clip.id
