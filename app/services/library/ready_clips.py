"""Clips that are ready: what most use cases begin with."""

from __future__ import annotations

from collections.abc import Sequence

from app.errors import ClipNotFound, ClipNotReady, Place
from app.numerics.arrays import FloatArray
from app.search.index import usable_arrays
from app.services.library.library import Library
from app.store.clips import repository as stored
from app.store.clips.record import ClipRecord, ClipState
from app.store.database.engine import Tx


def ready_clip(lib: Library, clip_id: str) -> ClipRecord:
    """A clip that is ready; raises ClipNotFound, ClipNotReady."""
    with lib.store.read() as tx:
        return read_ready_clip(tx, clip_id)


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


def read_ready_clip(tx: Tx, clip_id: str) -> ClipRecord:
    """A clip that is ready, in a transaction; raises ClipNotFound, ClipNotReady."""
    clip = stored.get(tx, clip_id)
    if clip.state is not ClipState.READY:
        where = Place("clip_id", f"is {clip.state.value}")
        raise ClipNotReady(f"The clip {clip_id} is {clip.state.value}.", places=[where])
    return clip


def descriptors_of(tx: Tx, clip: ClipRecord, names: Sequence[str]) -> dict[str, FloatArray]:
    """Stored arrays of a clip by name. Raises ClipNotReady where this version of Kinedex cannot
    use them, since the clip waits to be analysed again."""
    found = usable_arrays.get_some(tx, clip.id, names)
    missing = [name for name in names if name not in found]
    if missing:
        told = "was analyzed by another version of Kinedex and is to be analyzed again"
        where = Place("clip_id", f"{told}: {', '.join(missing)} cannot be used")
        raise ClipNotReady(f"The clip {clip.id} {told}; ask again after that.", places=[where])
    return {name: found[name] for name in names}
