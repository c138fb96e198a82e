"""The joint rotations of a ready clip: those of its file, if it has any, else solved ones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.errors import BadContent, FileDamaged, StoredFileMissing
from app.motion.motion import Motion
from app.motion.posing.file_rotations import animation_of_recording
from app.motion.skeleton.animation import Animation, animation_of_positions
from app.motion.skeleton.resampling import resample
from app.services.clips.ingest import analysis_request
from app.services.library.library import Library
from app.store.clips.record import ClipRecord

POSITION_FORMATS = frozenset({"c3d", "csv", "json", "npy", "trc", "tsv"})
"""File formats without rotations; such files need not be read again."""


def own_animation(lib: Library, clip: ClipRecord, motion: Motion, rate: float) -> Animation:
    """The clip's joint rotations at `rate` Hz: those of its file, else solved from positions."""
    return file_animation(lib, clip, motion, rate) or solved_animation(motion, rate)


def file_animation(lib: Library, clip: ClipRecord, motion: Motion, rate: float) -> Animation | None:
    """The rotations of the clip's file at `rate` Hz; None if it has none, or no longer gives the
    stored positions. A child process reads the file."""
    if clip.format in POSITION_FORMATS:
        return None
    try:
        recording = lib.pool.read(analysis_request(lib, clip))
    except (BadContent, FileDamaged, StoredFileMissing):
        return None  # the stored positions are enough
    animation = animation_of_recording(recording, motion)
    return None if animation is None else animation.resampled(rate)


def solved_animation(motion: Motion, rate: float) -> Animation:
    """Rotations at `rate` Hz that are solved from the positions."""
    motion = resampled(motion, rate)
    return animation_of_positions(motion.names, motion.parents, motion.positions, rate)


def resampled(motion: Motion, rate: float) -> Motion:
    """The motion at `rate` Hz."""
    if rate == motion.frame_rate:
        return motion
    positions = resample(motion.positions, motion.frame_rate, rate)
    return replace(motion, positions=positions.astype(np.float32), frame_rate=rate)
