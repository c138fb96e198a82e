"""Pictures of a clip's self-similarity matrices and motion volume (Sun 2011, figures 3 and 5)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.analysis.descriptors.active_part import active_span
from app.analysis.descriptors.motion_volume import self_similarity
from app.motion.frame.body_frame import ANALYSIS_RATE, smooth_track
from app.numerics.arrays import FloatArray
from app.services import fields
from app.services.figures.volume import matrix_svg, volume_svg
from app.services.library.library import Library
from app.services.library.ready_clips import ready_clip
from app.services.library.stored_motion import load_motion
from app.services.volume_options import MAX_SLICES, VolumeOptions


@dataclass(frozen=True, slots=True)
class _Matrices:
    """(n, 13, 13) matrices at ANALYSIS_RATE, of the active part, which begins at `start` seconds.

    name: of the clip; settings: a text of q and eta.
    """

    matrices: FloatArray
    start: float
    name: str
    settings: str

    @property
    def largest(self) -> float:
        return float(self.matrices.max())


def ssm_svg(lib: Library, clip_id: str, time: float | None, options: VolumeOptions) -> str:
    """The self-similarity matrix of the pose at `time` seconds as SVG.

    time: None for the middle of the clip's active part. Raises BadField, ClipNotFound,
    ClipNotReady.
    """
    found = _matrices(lib, clip_id, options, whole=time is not None)
    frame = len(found.matrices) // 2 if time is None else round(time * ANALYSIS_RATE)
    if not 0 <= frame < len(found.matrices):
        duration = (len(found.matrices) - 1) / ANALYSIS_RATE
        raise fields.bad_field("time", f"must be 0 to {duration:.2f} s")
    at = found.start + frame / ANALYSIS_RATE
    title = f"{found.name}, {at:.2f} s, {found.settings}"
    return matrix_svg(found.matrices[frame], found.largest, title)


def msv_svg(lib: Library, clip_id: str, slices: int, options: VolumeOptions) -> str:
    """Some slices of the clip's motion volume, evenly over its active part, as SVG.

    Raises BadField, ClipNotFound, ClipNotReady.
    """
    if not 2 <= slices <= MAX_SLICES:
        raise fields.bad_field("slices", f"must be 2 to {MAX_SLICES}")
    found = _matrices(lib, clip_id, options, whole=False)
    frames = np.linspace(0, len(found.matrices) - 1, min(slices, len(found.matrices))).round()
    chosen = frames.astype(np.int64)
    times = (found.start + chosen / ANALYSIS_RATE).tolist()
    title = f"{found.name}, motion volume, {found.settings}"
    return volume_svg(found.matrices[chosen], times, found.largest, title)


def _matrices(lib: Library, clip_id: str, options: VolumeOptions, *, whole: bool) -> _Matrices:
    """whole: of all frames, not only of the active part."""
    options.check_values()
    clip = ready_clip(lib, clip_id)
    track = smooth_track(load_motion(lib, clip))
    first, stop = (0, track.frames) if whole else active_span(track)
    matrices = self_similarity(track.local[first:stop], q=options.q, threshold=options.eta)
    settings = f"q = {options.q}, " + (
        f"dark: at most {options.eta:g} body lengths apart"
        if options.eta
        else f"darkest: {float(matrices.max()):.2f} body lengths"
    )
    return _Matrices(matrices, first / ANALYSIS_RATE, clip.name, settings)
