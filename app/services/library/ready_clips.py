"""Reading ready clips, and clear errors for clips that are missing or not ready."""

from __future__ import annotations

from collections.abc import Sequence

from app.errors import ClipNotFound, ClipNotReady
from app.kinedex_error import Place
from app.numerics.arrays import FloatArray
from app.search.index import usable_arrays
from app.services.library.library import Library
from app.store.clips import repository as stored
from app.store.clips.record import ClipRecord, ClipState
from app.store.database.engine import Tx


def ready_clip(lib: Library, clip_id: str) -> ClipRecord:
    """A ready clip by id. Raises ClipNotFound, ClipNotReady."""
    with lib.store.read() as tx:
        return read_ready_clip(tx, clip_id)


def ready_clips(lib: Library, clip_ids: Sequence[str], field: str) -> dict[str, ClipRecord]:
    """Ready clips by id, in the order of `clip_ids`. A repeated id gives one clip.

    field: the name of the client's field that holds the ids. An error names each wrong id by its
    index in that field. Raises ClipNotFound, ClipNotReady.
    """
    with lib.store.read() as tx:
        clips = stored.get_many(tx, dict.fromkeys(clip_ids))
    unknown = [index for index, clip_id in enumerate(clip_ids) if clip_id not in clips]
    if unknown:
        names = list(dict.fromkeys(repr(clip_ids[index]) for index in unknown))
        which = "is no clip with the id" if len(names) == 1 else "are no clips with the ids"
        places = [Place(f"{field}.{index}", "is the id of no clip") for index in unknown]
        raise ClipNotFound(f"There {which} {', '.join(names)}", places=places)
    not_ready = [
        Place(f"{field}.{index}", f"is {clips[clip_id].state.value}")
        for index, clip_id in enumerate(clip_ids)
        if clips[clip_id].state is not ClipState.READY
    ]
    if not_ready:
        raise ClipNotReady("Some of the clips are not ready.", places=not_ready)
    return clips


def read_ready_clip(tx: Tx, clip_id: str) -> ClipRecord:
    """A ready clip by id, in the caller's transaction. Raises ClipNotFound, ClipNotReady."""
    clip = stored.get(tx, clip_id)
    if clip.state is not ClipState.READY:
        where = Place("clip_id", f"is {clip.state.value}")
        raise ClipNotReady(f"The clip {clip_id} is {clip.state.value}.", places=[where])
    return clip


def descriptors_of(tx: Tx, clip: ClipRecord, names: Sequence[str]) -> dict[str, FloatArray]:
    """The stored arrays of a clip, by name.

    Raises ClipNotReady if this version of Kinedex cannot use one of them: then the clip waits
    for a new analysis.
    """
    usable = usable_arrays.get_some(tx, clip.id, names)
    missing = [name for name in names if name not in usable]
    if missing:
        reason = "was analyzed by another version of Kinedex and will be analyzed again"
        where = Place("clip_id", f"{reason}: {', '.join(missing)} cannot be used")
        raise ClipNotReady(f"The clip {clip.id} {reason}; try again after that.", places=[where])
    return {name: usable[name] for name in names}
