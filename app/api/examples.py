"""Ids for the examples of `/docs`, so that a reader can run them as they stand."""

from __future__ import annotations

from app.api.guard.callers import is_open
from app.services.library.library import Library
from app.store.clips import listing as clip_listing
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipState
from app.store.jobs import repository as jobs

_READY = ClipFilter(state=(ClipState.READY,))


def example_ids(library: Library | None) -> dict[str, str]:
    """The newest ready clip and the newest job, by placeholder.

    Empty where a key is needed: the description is for everyone, ids are not.
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
