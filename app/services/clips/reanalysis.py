"""Analyzing stored clips again: those of an earlier analysis version, failed ones, or all.

The original file of each clip is stored, so that a better analysis can compute everything again.
A ready clip stays ready and searchable with the analysis that it has, until the new one replaces
it in one transaction. So during an upgrade searches use analyses of two versions: a hit may come
from the older one. If the older arrays of a clip have another shape, the index that needs them
leaves the clip out until its new analysis is done.
"""

from __future__ import annotations

from collections.abc import Sequence

from app.analysis.analyze import ANALYSIS_VERSION
from app.services.clips.catalogue import BULK_PRIORITY, enqueue_ingest
from app.services.library.keypose_thresholds import (
    KEYPOSE_THRESHOLDS,
    library_thresholds,
    thresholds_array,
)
from app.services.library.library import Library
from app.store.clips import listing as clip_listing
from app.store.clips import repository as clips
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipState

BATCH = 200
"""Clips queued in one transaction, so that others need not wait."""


def requeue_outdated(lib: Library) -> int:
    """Queue the ready clips with an outdated analysis; returns how many.

    An analysis is outdated if it is of another version, or older than the last change of the hints
    or the recording, or if its keyposes have other thresholds than those of the library.
    """
    expected = thresholds_array(library_thresholds(lib))
    with lib.store.read() as tx:
        ids = clip_listing.list_outdated_ids(tx, ANALYSIS_VERSION)
        others = clip_listing.list_ids_with_other_array(tx, KEYPOSE_THRESHOLDS, expected)
    return _requeue(lib, sorted({*ids, *others}))


def requeue_ready(lib: Library) -> int:
    """Queue every ready clip; return how many."""
    with lib.store.read() as tx:
        ids = clip_listing.list_ids(tx, ClipFilter(state=(ClipState.READY,)))
    return _requeue(lib, ids)


def requeue_failed(lib: Library) -> int:
    """Queue every clip whose last analysis failed; return how many."""
    with lib.store.read() as tx:
        ids = clip_listing.list_unfit_ids(tx)
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
