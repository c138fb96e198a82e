"""The descriptors of a query: of a stored clip, of a part of one, or of an uploaded file."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from app.errors import BadField, EmptyFile, TooLarge
from app.kinedex_error import Place
from app.motion.frame.body_frame import ANALYSIS_RATE
from app.motion.motion import Motion
from app.numerics.arrays import FloatArray
from app.search.windows.proposals import ExcludedInterval
from app.services import fields
from app.services.find.query_source import UPLOAD_ONLY, QuerySource
from app.services.library.analysis_pool import AnalysisRequest
from app.services.library.library import Library
from app.services.library.ready_clips import descriptors_of, read_ready_clip
from app.services.library.stored_motion import load_motion
from app.store.clips.record import ClipRecord, content_key
from app.store.clips.repository import find_by_content
from app.store.files.files import Readable

Arrays = Mapping[str, FloatArray]


@dataclass(frozen=True, slots=True)
class QueryDescriptors:
    """The descriptors of a query.

    arrays: descriptors by name, see `app.analysis.array_shapes`; clip: the stored clip, if the
    query is one; stored_as: the clip that was made from the same file, if the query is an upload
    that the library already has; motion: of an upload, or of a part of a clip.
    """

    source: QuerySource
    arrays: Arrays
    clip: ClipRecord | None
    stored_as: ClipRecord | None = None
    motion: Motion | None = None

    @property
    def seconds(self) -> float:
        """The duration of the selected part, in seconds."""
        start, end = self.source.start or 0.0, self.source.end
        if end is not None:
            return end - start
        if self.clip is not None:
            return (self.clip.duration or 0.0) - start
        # These positions are of the part alone: an upload is cut before it is described.
        return len(self.arrays["role_positions"]) / ANALYSIS_RATE

    @property
    def interval(self) -> ExcludedInterval | None:
        """The selected part of a stored clip, in seconds; None for a new motion."""
        if self._itself is None:
            return None
        start = self.source.start or 0.0
        return ExcludedInterval(self._itself.id, start, start + self.seconds)

    def excluded_clips(self, *, include_self: bool) -> frozenset[str]:
        """Ids of the clips that must not be hits: the query's own, unless `include_self`."""
        return frozenset({self._itself.id} if self._itself and not include_self else ())

    @property
    def _itself(self) -> ClipRecord | None:
        """The clip in the library that has the query's motion."""
        return self.clip or self.stored_as


def describe(lib: Library, source: QuerySource, names: tuple[str, ...]) -> QueryDescriptors:
    """The named descriptors of a query. An upload is not stored.

    names: keys of `app.analysis.array_shapes.SHAPES`. Raises BadField, ClipNotFound, ClipNotReady,
    TooLarge, and BadContent for an upload that cannot be used.
    """
    if (source.clip_id is None) == (source.content is None):
        places = [Place("clip_id", "exactly one of clip_id and file must be given")]
        raise BadField("Give either a clip_id or a file.", places=places)
    _check_part(source)
    if source.clip_id is not None:
        return _describe_clip(lib, source, source.clip_id, names)
    request = analysis_request(source, lib.settings.max_upload_bytes)
    analysis = lib.pool.analyze(request)
    motion = analysis.motion
    if not source.is_whole:
        motion = cut(motion, source.start, source.end)
    # the motion symbol is slow, so an upload has it only if it is asked for
    known = analysis.arrays if source.is_whole else {}
    missing = tuple(name for name in names if name not in known)
    arrays = known | _described(motion, missing) if missing else known
    return QueryDescriptors(source, arrays, None, _stored_as(lib, request), motion)


def query_motion(lib: Library, query: QueryDescriptors) -> Motion:
    """The motion of a query that `describe` has described."""
    if query.motion is not None:
        return query.motion
    if query.clip is None:
        raise ValueError("a query is a clip or has a motion")
    return load_motion(lib, query.clip)


def analysis_request(source: QuerySource, max_bytes: int) -> AnalysisRequest:
    """The analysis of an uploaded query; reads the upload into memory.

    max_bytes: upper limit for each of its files. Raises BadField, EmptyFile, TooLarge.
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
    """The frames of `motion` from `start` to `end` seconds, at least one frame.

    Raises BadField if the part is outside of the motion.
    """
    start_s = 0.0 if start is None else start
    end_s = motion.duration if end is None else end
    if start_s >= motion.duration:
        raise fields.bad_field("start", f"must be below the duration, {motion.duration:.3f} s")
    # One frame more is allowed, since clients round durations.
    if end_s > motion.duration + 1.0 / motion.frame_rate:
        raise fields.bad_field("end", f"must not be beyond the duration, {motion.duration:.3f} s")
    # 1e-6: a time that is exactly on a frame must not fall to its neighbor by rounding.
    first = math.floor(start_s * motion.frame_rate + 1e-6)
    stop = max(first + 1, math.ceil(end_s * motion.frame_rate - 1e-6))
    return replace(motion, positions=np.ascontiguousarray(motion.positions[first:stop]))


def _describe_clip(
    lib: Library, source: QuerySource, clip_id: str, names: tuple[str, ...]
) -> QueryDescriptors:
    for name in UPLOAD_ONLY:
        if getattr(source, name) not in (None, ""):
            raise fields.bad_field(name, "is for an uploaded file, not for a stored clip")
    with lib.store.read() as tx:
        clip = read_ready_clip(tx, clip_id)
        if source.is_whole:
            return QueryDescriptors(source, descriptors_of(tx, clip, names), clip)
    part = cut(load_motion(lib, clip), source.start, source.end)
    return QueryDescriptors(source, _described(part, names), clip, motion=part)


def _stored_as(lib: Library, request: AnalysisRequest) -> ClipRecord | None:
    """The clip of the uploaded file and of the same animation stack; None if it is not stored."""
    skeleton = request.skeleton
    key = content_key(
        hashlib.sha256(request.content or b"").hexdigest(),
        None if skeleton is None else hashlib.sha256(skeleton).hexdigest(),
    )
    with lib.store.read() as tx:
        clip = find_by_content(tx, key)
    return clip if clip is not None and clip.hints.stack == request.stack else None


def _described(motion: Motion, names: tuple[str, ...]) -> dict[str, FloatArray]:
    """The named descriptors of a part of a motion, computed in this process."""
    # The analysis is slow to import, and a search by a whole clip does not need it.
    from app.analysis.analyze import describe_for_search

    return describe_for_search(motion, names).arrays


def _read(content: Readable | None, max_bytes: int) -> bytes:
    # One byte more than the limit shows that the file is too large.
    data = content.read(max_bytes + 1) if content is not None else b""
    if not data:
        raise EmptyFile()
    if len(data) > max_bytes:
        raise TooLarge(f"The file is larger than {max_bytes} bytes.")
    return data


def _check_part(source: QuerySource) -> None:
    for name in ("start", "end"):
        value = getattr(source, name)
        if value is not None and not (math.isfinite(value) and value >= 0):
            raise fields.bad_field(name, "must be a number of seconds, zero or more")
    if source.start is not None and source.end is not None and source.end <= source.start:
        raise fields.bad_field("end", "must be after start")
