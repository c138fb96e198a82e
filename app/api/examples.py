"""Ids for the examples of `/docs`: with them, a reader can run the examples unchanged."""

from __future__ import annotations

from app.api.guard.callers import is_open
from app.services.library.library import Library
from app.store.clips import listing as clip_listing
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipState
from app.store.jobs import repository as jobs

_READY = ClipFilter(state=(ClipState.READY,))


def example_ids(library: Library | None) -> dict[str, str]:
    """Return the ids of the newest ready clip and of the newest job, by placeholder.

    The result is empty if calls need a key: everyone may read the description, but not the ids.
    """
    if library is None:
        return {}
    with library.store.read() as tx:
        if not is_open(library, tx):
            return {}
        clips = clip_listing.list_clips(tx, _READY, limit=1).items
        newest = jobs.list_jobs(tx, limit=1).items
    ids = {}
    if clips:
        ids["CLIP_ID"] = clips[0].id
    if newest:
        ids["JOB_ID"] = newest[0].id
    return ids
