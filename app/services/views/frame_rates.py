"""Checks the frame rate that a client requests, for all calls that take one."""

from __future__ import annotations

import math

from app.services import fields
from app.services.library.library import Library
from app.store.clips.record import ClipRecord

MIN_FPS, MAX_FPS = 1.0, 1000.0
"""Bounds of a requested frame rate, in Hz."""

MAX_POSITIONS = 30_000_000
"""Largest number of frames times joints that one call reads or makes. An hour at 120 Hz with 60
joints has 26 million. At the limit, the coordinates take 360 MB as float32."""


def requested_rate(
    lib: Library, clip: ClipRecord, fps: float | None, *, source: float, joints: int
) -> float:
    """The frame rate: `fps`, or if it is None, the rate `source` (Hz) of the motion.

    joints: number of joints of the motion. Raises BadField for a rate out of bounds, and for a
    rate that would make too many frames or too much work.
    """
    if fps is None or fps == source:
        return source
    if not (math.isfinite(fps) and MIN_FPS <= fps <= MAX_FPS):
        raise fields.bad_field("fps", f"must be from {MIN_FPS:g} to {MAX_FPS:g}")
    # A clip may have more frames than the limit, if the limit was lowered after its upload.
    seconds, max_frames = clip.duration or 0.0, max(lib.settings.max_frames, clip.frames or 0)
    if fps * seconds > max_frames:
        raise fields.bad_field("fps", f"would make more than {max_frames} frames")
    # Resampling to a lower rate also costs work: it reads all frames of the source.
    if max(fps, source) * seconds * joints > MAX_POSITIONS:
        message = (
            f"resampling {seconds:.0f} s of {joints} joints from {source:g} to {fps:g} Hz is too "
            f"much work: at either rate, at most {MAX_POSITIONS:,} positions (frames times joints) "
            "are allowed"
        )
        raise fields.bad_field("fps", message)
    return fps
