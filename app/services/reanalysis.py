"""Analysing stored clips anew: those of an earlier analysis, failed ones, or all.

A clip's file is kept, so that whatever an analysis finds can be found again by a better one.
A clip that waits for it is not searchable: vectors of two analyses must not be compared.
"""

from __future__ import annotations

from collections.abc import Sequence

from app.analysis.analyse import ANALYSIS_VERSION
from app.services.clips import BULK_PRIORITY, enqueue_ingest
from app.services.library import Library
from app.store import clip_listing, clips
from app.store.clip_filter import ClipFilter
from app.store.clip_record import ClipState

BATCH = 200
"""Clips queued in one transaction, so that others need not wait."""


def requeue_outdated(lib: Library) -> int:
    """Queue the ready clips that another version of the analysis described; how many."""
    with lib.store.read() as tx:
        ids = clip_listing.list_ids_of_other_analysis(tx, ANALYSIS_VERSION)
    return _requeue(lib, ids)


def requeue_in_state(lib: Library, *states: ClipState) -> int:
    """Queue every clip that is in one of `states`; how many."""
    with lib.store.read() as tx:
        ids = clip_listing.list_ids(tx, ClipFilter(state=states))
    return _requeue(lib, ids)


def _requeue(lib: Library, ids: Sequence[str]) -> int:
    queued = 0
    for batch in clips.in_batches(ids, BATCH):
        with lib.store.write() as tx:
            for clip_id in clips.get_many(tx, batch):  # without those deleted meanwhile
                enqueue_ingest(tx, clip_id, BULK_PRIORITY)
                clips.requeue(tx, clip_id)
                queued += 1
    return queued
