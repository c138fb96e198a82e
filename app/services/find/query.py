"""What a search or a recognition asks about: a stored clip, a part of one, or an upload."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from app.errors import BadField, EmptyFile, Place, TooLarge
from app.motion.motion import Motion
from app.numerics.arrays import FloatArray
from app.services import fields
from app.services.library.analysis_pool import Order
from app.services.library.library import Library
from app.services.library.ready_clips import descriptors_of, find_ready
from app.services.library.stored_motion import load_motion
from app.store.clips.record import ClipRecord
from app.store.files.files import Readable

Arrays = Mapping[str, FloatArray]


@dataclass(frozen=True, slots=True)
class Question:
    """Exactly one of `clip_id` and `content`, and what is said of it.

    start, end: seconds, the part that is meant; skeleton, frame_rate, unit, roles, stack:
    of an upload only.
    """

    clip_id: str | None = None
    content: Readable | None = None
    start: float | None = None
    end: float | None = None
    skeleton: Readable | None = None
    frame_rate: float | str | None = None
    unit: float | str | None = None
    roles: Mapping[str, str] | None = None
    stack: str | None = None


@dataclass(frozen=True, slots=True)
class Answered:
    """A question's descriptors by name, and the stored clip that it is about, if any."""

    arrays: Arrays
    clip: ClipRecord | None


def describe(lib: Library, question: Question, names: tuple[str, ...]) -> Answered:
    """The named descriptors of what is asked about; nothing of an upload is stored.

    Raises BadField, ClipNotFound, ClipNotReady, TooLarge, and BadContent for an upload that
    cannot be used.
    """
    if (question.clip_id is None) == (question.content is None):
        places = [Place("clip_id", "exactly one of clip_id and file must be given")]
        raise BadField("Give either a clip_id or a file.", places=places)
    _check_part(question)
    if question.clip_id is not None:
        return _of_clip(lib, question, question.clip_id, names)
    return Answered(_of_upload(lib, question, names), None)


def _of_clip(lib: Library, question: Question, clip_id: str, names: tuple[str, ...]) -> Answered:
    for name in ("skeleton", "frame_rate", "unit", "roles", "stack"):
        if getattr(question, name) not in (None, ""):
            raise fields.bad_field(name, "goes with an uploaded file, not with a stored clip")
    with lib.store.read() as tx:
        clip = find_ready(tx, clip_id)
        if question.start is None and question.end is None:
            return Answered(descriptors_of(tx, clip, names), clip)
    motion = cut(load_motion(lib, clip), question.start, question.end)
    return Answered(_described(motion, names), clip)


def _of_upload(lib: Library, question: Question, names: tuple[str, ...]) -> Arrays:
    found = lib.pool.analyze(_order(lib, question))
    if question.start is None and question.end is None:
        return found.arrays
    return _described(cut(found.motion, question.start, question.end), names)


def _described(motion: Motion, names: tuple[str, ...]) -> Arrays:
    """The named descriptors of a part of a motion, computed here and now."""
    # The analysis is slow to import, and a search by a whole clip does not need it.
    from app.analysis.analyze import describe_for_search

    return describe_for_search(motion, names).arrays


def _order(lib: Library, question: Question) -> Order:
    return Order(
        content=_read(question.content, lib.settings.max_upload_bytes),
        skeleton=_skeleton(question, lib.settings.max_upload_bytes),
        stack=fields.text("stack", question.stack),
        frame_rate=fields.frame_rate(question.frame_rate),
        metres_per_unit=fields.metres_per_unit(question.unit),
        roles=fields.roles(question.roles),
        for_search=True,
    )


def _read(content: Readable | None, limit: int) -> bytes:
    found = content.read(limit + 1) if content is not None else b""
    if not found:
        raise EmptyFile()
    if len(found) > limit:
        raise TooLarge(f"The file is larger than {limit} bytes.")
    return found


def _skeleton(question: Question, limit: int) -> bytes | None:
    return None if question.skeleton is None else _read(question.skeleton, limit)


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


def _check_part(question: Question) -> None:
    for name in ("start", "end"):
        value = getattr(question, name)
        if value is not None and not (math.isfinite(value) and value >= 0):
            raise fields.bad_field(name, "must be a number of seconds, zero or more")
    if question.start is not None and question.end is not None and question.end <= question.start:
        raise fields.bad_field("end", "must be after start")
