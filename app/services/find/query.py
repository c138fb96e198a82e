"""The descriptors of a query: of a stored clip, of a part of one, or of an uploaded file."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from app.errors import BadField, EmptyFile, Place, TooLarge
from app.motion.frame.body_frame import ANALYSIS_RATE
from app.motion.motion import Motion
from app.numerics.arrays import FloatArray
from app.search.windows.proposals import ExcludedInterval
from app.services import fields
from app.services.find.query_source import UPLOAD_ONLY, QuerySource
from app.services.library.analysis_pool import AnalysisRequest
from app.services.library.library import Library
from app.services.library.ready_clips import descriptors_of, find_ready
from app.services.library.stored_motion import load_motion
from app.store.clips.record import ClipRecord
from app.store.files.files import Readable

Arrays = Mapping[str, FloatArray]


@dataclass(frozen=True, slots=True)
class QueryDescriptors:
    """What is computed of a query: descriptors by name; clip: the stored clip, if it is one."""

    source: QuerySource
    arrays: Arrays
    clip: ClipRecord | None

    @property
    def seconds(self) -> float:
        """The duration of the part that is meant."""
        start, end = self.source.start or 0.0, self.source.end
        if end is not None:
            return end - start
        if self.clip is not None:
            return (self.clip.duration or 0.0) - start
        # These positions are of the part alone: an upload is cut before it is described.
        return len(self.arrays["role_positions"]) / ANALYSIS_RATE

    @property
    def interval(self) -> ExcludedInterval | None:
        """Where the part that is meant lies in a stored clip; None for an upload."""
        if self.clip is None:
            return None
        start = self.source.start or 0.0
        return ExcludedInterval(self.clip.id, start, start + self.seconds)


def describe(lib: Library, source: QuerySource, names: tuple[str, ...]) -> QueryDescriptors:
    """The named descriptors of a query. Nothing of an upload is stored.

    Raises BadField, ClipNotFound, ClipNotReady, TooLarge, and BadContent for an upload that
    cannot be used.
    """
    if (source.clip_id is None) == (source.content is None):
        places = [Place("clip_id", "exactly one of clip_id and file must be given")]
        raise BadField("Give either a clip_id or a file.", places=places)
    _check_part(source)
    if source.clip_id is not None:
        return _describe_clip(lib, source, source.clip_id, names)
    return QueryDescriptors(source, _describe_upload(lib, source, names), None)


def analysis_request(source: QuerySource, max_bytes: int) -> AnalysisRequest:
    """The analysis of an uploaded query; reads the upload.

    max_bytes: the most that each of its files may have. Raises BadField, EmptyFile, TooLarge.
    """
    skeleton = source.skeleton
    return AnalysisRequest(
        content=_read(source.content, max_bytes),
        skeleton=None if skeleton is None else _read(skeleton, max_bytes),
        stack=fields.text("stack", source.stack),
        frame_rate=fields.frame_rate(source.frame_rate),
        metres_per_unit=fields.metres_per_unit(source.unit),
        up_axis=fields.up_axis(source.up_axis),
        roles=fields.roles(source.roles),
        for_search=True,
    )


def cut(motion: Motion, start: float | None, end: float | None) -> Motion:
    """The frames of `motion` from `start` to `end` seconds; raises BadField outside of it."""
    first = 0.0 if start is None else start
    last = motion.duration if end is None else end
    if first >= motion.duration:
        raise fields.bad_field("start", f"must be below the duration, {motion.duration:.3f} s")
    if last > motion.duration + 1.0 / motion.frame_rate:
        raise fields.bad_field("end", f"must not be beyond the duration, {motion.duration:.3f} s")
    begin = math.floor(first * motion.frame_rate + 1e-6)
    stop = max(begin + 1, math.ceil(last * motion.frame_rate - 1e-6))
    return replace(motion, positions=np.ascontiguousarray(motion.positions[begin:stop]))


def _describe_clip(
    lib: Library, source: QuerySource, clip_id: str, names: tuple[str, ...]
) -> QueryDescriptors:
    for name in UPLOAD_ONLY:
        if getattr(source, name) not in (None, ""):
            raise fields.bad_field(name, "goes with an uploaded file, not with a stored clip")
    with lib.store.read() as tx:
        clip = find_ready(tx, clip_id)
        if source.is_whole:
            return QueryDescriptors(source, descriptors_of(tx, clip, names), clip)
    part = cut(load_motion(lib, clip), source.start, source.end)
    return QueryDescriptors(source, _described(part, names), clip)


def _describe_upload(lib: Library, source: QuerySource, names: tuple[str, ...]) -> Arrays:
    found = lib.pool.analyze(analysis_request(source, lib.settings.max_upload_bytes))
    if source.is_whole:
        return found.arrays
    return _described(cut(found.motion, source.start, source.end), names)


def _described(motion: Motion, names: tuple[str, ...]) -> Arrays:
    """The named descriptors of a part of a motion, computed in this process."""
    # The analysis is slow to import, and a search by a whole clip does not need it.
    from app.analysis.analyze import describe_for_search

    return describe_for_search(motion, names).arrays


def _read(content: Readable | None, max_bytes: int) -> bytes:
    found = content.read(max_bytes + 1) if content is not None else b""
    if not found:
        raise EmptyFile()
    if len(found) > max_bytes:
        raise TooLarge(f"The file is larger than {max_bytes} bytes.")
    return found


def _check_part(source: QuerySource) -> None:
    for name in ("start", "end"):
        value = getattr(source, name)
        if value is not None and not (math.isfinite(value) and value >= 0):
            raise fields.bad_field(name, "must be a number of seconds, zero or more")
    if source.start is not None and source.end is not None and source.end <= source.start:
        raise fields.bad_field("end", "must be after start")
