"""What a search or a recognition asks about: a stored clip, a part of one, or an upload."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.errors import BadField, ClipNotFound, ClipNotReady, EmptyFile, Place, TooLarge
from app.motion.canonical.motion import Motion
from app.numerics.arrays import FloatArray
from app.search.index import usable_arrays
from app.services import fields
from app.services.analysis_pool import Order
from app.services.library import Library
from app.services.stored_motion import load_motion
from app.store.clips import repository as stored
from app.store.clips.record import ClipRecord, ClipState
from app.store.database.engine import Tx
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


def ready_clip(lib: Library, clip_id: str) -> ClipRecord:
    """A clip that is ready; raises ClipNotFound, ClipNotReady."""
    with lib.store.read() as tx:
        return _ready(tx, clip_id)


def ready_clips(lib: Library, clip_ids: Sequence[str], field: str) -> dict[str, ClipRecord]:
    """Clips that are ready, by id, each once, in the order asked for.

    field: which holds the ids: every one that is wrong is named by its place in it. Raises
    ClipNotFound, ClipNotReady.
    """
    with lib.store.read() as tx:
        found = stored.get_many(tx, dict.fromkeys(clip_ids))
    unknown = [place for place, clip_id in enumerate(clip_ids) if clip_id not in found]
    if unknown:
        names = list(dict.fromkeys(repr(clip_ids[place]) for place in unknown))
        which = "is no clip with the id" if len(names) == 1 else "are no clips with the ids"
        places = [Place(f"{field}.{place}", "is the id of no clip") for place in unknown]
        raise ClipNotFound(f"There {which} {', '.join(names)}", places=places)
    waiting = [
        Place(f"{field}.{place}", f"is {found[clip_id].state.value}")
        for place, clip_id in enumerate(clip_ids)
        if found[clip_id].state is not ClipState.READY
    ]
    if waiting:
        raise ClipNotReady("Some of the clips are not ready.", places=waiting)
    return found


def _ready(tx: Tx, clip_id: str) -> ClipRecord:
    clip = stored.get(tx, clip_id)
    if clip.state is not ClipState.READY:
        where = Place("clip_id", f"is {clip.state.value}")
        raise ClipNotReady(f"The clip {clip_id} is {clip.state.value}.", places=[where])
    return clip


def described(tx: Tx, clip: ClipRecord, names: Sequence[str]) -> dict[str, FloatArray]:
    """Stored arrays of a clip by name. Raises ClipNotReady where this version of Kinedex cannot
    use them, since the clip waits to be analysed again."""
    found = usable_arrays.get_some(tx, clip.id, names)
    missing = [name for name in names if name not in found]
    if missing:
        told = "was analyzed by another version of Kinedex and is to be analyzed again"
        where = Place("clip_id", f"{told}: {', '.join(missing)} cannot be used")
        raise ClipNotReady(f"The clip {clip.id} {told}; ask again after that.", places=[where])
    return {name: found[name] for name in names}


def _of_clip(lib: Library, question: Question, clip_id: str, names: tuple[str, ...]) -> Answered:
    for name in ("skeleton", "frame_rate", "unit", "roles", "stack"):
        if getattr(question, name) not in (None, ""):
            raise fields.bad_field(name, "goes with an uploaded file, not with a stored clip")
    with lib.store.read() as tx:
        clip = _ready(tx, clip_id)
        if question.start is None and question.end is None:
            return Answered(described(tx, clip, names), clip)
    motion = cut(load_motion(lib, clip), question.start, question.end)
    return Answered(_described(motion, names), clip)


def _of_upload(lib: Library, question: Question, names: tuple[str, ...]) -> Arrays:
    found = lib.pool.analyse(_order(lib, question))
    if question.start is None and question.end is None:
        return found.arrays
    return _described(cut(found.motion, question.start, question.end), names)


def _described(motion: Motion, names: tuple[str, ...]) -> Arrays:
    """The named descriptors of a part of a motion, computed here and now."""
    # The analysis is slow to import, and a search by a whole clip does not need it.
    from app.analysis.analyse import describe_for_search

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
