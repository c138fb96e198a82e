"""Exports a ready clip as a file for other programs: BVH, GLB, NPZ or CSV.

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
from enum import StrEnum
from typing import TypeVar

import numpy as np

from app.errors import BadContent, FileDamaged, StoredFileMissing
from app.formats.bvh.export import write_animation_bvh
from app.formats.csv_writer import write_csv
from app.formats.gltf.writer import write_glb
from app.formats.npz.writer import write_npz
from app.motion.frame.body_frame import ANALYSIS_RATE
from app.motion.motion import Motion
from app.motion.posing.canonical_body import on_canonical_body
from app.motion.posing.file_rotations import animation_of_recording
from app.motion.roles.joint_roles import SUN_ROLES
from app.motion.skeleton.animation import Animation, animation_of_positions
from app.motion.skeleton.resampling import resample
from app.numerics.arrays import FloatArray, IntArray
from app.services import fields
from app.services.clips.ingest import analysis_request
from app.services.library.library import Library
from app.services.library.ready_clips import ready_clip
from app.services.library.stored_motion import load_motion
from app.services.views.export_format import ExportFormat, ExportSkeleton
from app.services.views.frame_rates import wanted_rate
from app.services.views.low_dimensional import Reduction, as_motion, reduce
from app.store.clips.record import ClipRecord

_Kind = TypeVar("_Kind", bound=StrEnum)

POSITION_FORMATS = frozenset({"c3d", "csv", "json", "npy", "trc", "tsv"})
"""File formats without rotations; such files need not be read again."""


@dataclass(frozen=True, slots=True)
class Export:
    """A file: its name, and its content in pieces."""

    file_name: str
    blocks: Iterable[bytes]


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
    fps: float | None = None,
    skeleton: ExportSkeleton | str = ExportSkeleton.OWN,
    reduction: Reduction | None = None,
) -> Export:
    """A clip as a file of `format`, resampled by time to `fps` (default: its own rate).

    reduction: reduce the motion to few dimensions, on the 13 joint roles, by default at 30 Hz.
    Raises BadField, ClipNotFound, ClipNotReady, NotEnoughKeyposes.
    """
    wanted = _choice("format", ExportFormat, format)
    body = _choice("skeleton", ExportSkeleton, skeleton)
    clip = ready_clip(lib, clip_id)
    source = clip.frame_rate or 1.0 if reduction is None else ANALYSIS_RATE
    joints = clip.joints or 0 if reduction is None else len(SUN_ROLES)
    rate = wanted_rate(lib, clip, fps, source=source, joints=joints)
    ending = "-canonical" if body is ExportSkeleton.CANONICAL else ""
    if reduction is None:
        motion = load_motion(lib, clip)
    else:
        found = reduce(lib, clip, reduction)
        motion = as_motion(found, clip)
        ending = f"-{found.basis.value}-{found.dimensions}dim{ending}"
    if body is ExportSkeleton.CANONICAL:
        blocks = _of_animation(wanted, on_canonical_body(_resampled(motion, rate)), clip)
    elif wanted in (ExportFormat.NPZ, ExportFormat.CSV):
        motion = _resampled(motion, rate)
        blocks = _of_positions(
            wanted, _Positions(motion.names, motion.parents, motion.positions, rate)
        )
    elif reduction is None:
        blocks = _of_animation(wanted, own_animation(lib, clip, motion, rate), clip)
    else:
        blocks = _of_animation(wanted, _solved(motion, rate), clip)
    return Export(f"{_safe_stem(clip)}{ending}.{wanted.value}", blocks)


def _choice(field: str, kind: type[_Kind], value: str) -> _Kind:
    try:
        return kind(value)
    except ValueError:
        raise fields.bad_field(field, f"must be one of {', '.join(kind)}") from None


def _resampled(motion: Motion, rate: float) -> Motion:
    if rate == motion.frame_rate:
        return motion
    positions = resample(motion.positions, motion.frame_rate, rate)
    return replace(motion, positions=positions.astype(np.float32), frame_rate=rate)


def own_animation(lib: Library, clip: ClipRecord, motion: Motion, rate: float) -> Animation:
    """The clip's joint rotations at `rate` Hz: those of its file, else solved from positions."""
    if clip.format not in POSITION_FORMATS:
        try:
            recording = lib.pool.read(analysis_request(lib, clip))
        except (BadContent, FileDamaged, StoredFileMissing):
            recording = None  # the stored positions are enough
        animation = animation_of_recording(recording, motion) if recording else None
        if animation is not None:
            return animation.resampled(rate)
    return _solved(motion, rate)


def _solved(motion: Motion, rate: float) -> Animation:
    motion = _resampled(motion, rate)
    return animation_of_positions(motion.names, motion.parents, motion.positions, rate)


def _of_animation(wanted: ExportFormat, animation: Animation, clip: ClipRecord) -> Iterable[bytes]:
    if wanted is ExportFormat.BVH:
        return write_animation_bvh(animation)
    if wanted is ExportFormat.GLB:
        return [write_glb(animation, clip.name, clip.license)]
    skeleton = animation.skeleton
    positions = animation.positions().astype(np.float32)
    return _of_positions(
        wanted, _Positions(skeleton.names, skeleton.parents, positions, animation.frame_rate)
    )


def _of_positions(wanted: ExportFormat, tracks: _Positions) -> Iterable[bytes]:
    if wanted is ExportFormat.NPZ:
        return [write_npz(tracks.names, tracks.parents, tracks.positions, tracks.frame_rate)]
    return write_csv(tracks.names, tracks.positions, tracks.frame_rate)


def _safe_stem(clip: ClipRecord) -> str:
    """The clip's name as a file name that is valid on all systems."""
    kept = "".join(c if c.isalnum() or c in " ._-()+" else "_" for c in clip.name)
    return kept.strip(" ._")[:100] or clip.id
