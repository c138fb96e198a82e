"""Whether to fit the models again: when the library has changed enough since the last fit."""

from __future__ import annotations

from app.store import models as stored
from app.store.clips import versions as library
from app.store.clips.filter import ClipFilter
from app.store.clips.listing import count_clips
from app.store.clips.record import ClipState
from app.store.database.engine import Tx
from app.store.jobs import repository as jobs
from app.store.jobs.record import JobKind, JobState

MIN_CLIPS = 2
"""Ready clips that an automatic fit needs: a model of one clip is useless."""
_READY = ClipFilter(state=(ClipState.READY,))


def is_fit_due(tx: Tx, growth: float) -> bool:
    """Whether the share `growth` of the library has changed since the last fit.

    Changes are clips that were added, analyzed again, labeled again or removed. A fit is never
    due while a fit or an ingest is open, or with fewer than MIN_CLIPS ready clips.
    """
    ready = count_clips(tx, _READY)
    if ready < MIN_CLIPS or _is_open(tx, JobKind.FIT) or _is_open(tx, JobKind.INGEST):
        return False
    last = _last_fit(tx)
    if last is None:
        return True
    version, size = last
    changes = library.changed_since(tx, version)
    return len(changes.changed) + len(changes.removed) >= max(growth * size, 1)


def _last_fit(tx: Tx) -> tuple[int, int] | None:
    """Library version and size of the last fit, even if it could not fit any model."""
    found = [(r.library_version, r.library_size) for r in stored.list_current(tx)]
    for job in jobs.list_jobs(tx, kind=JobKind.FIT, state=JobState.SUCCEEDED, limit=1).items:
        result = job.result or {}
        found.append((int(result["library_version"]), int(result["library_size"])))
    return max(found, default=None)


def _is_open(tx: Tx, kind: JobKind) -> bool:
    return any(
        jobs.list_jobs(tx, kind=kind, state=state, limit=1).items
        for state in (JobState.QUEUED, JobState.PROCESSING)
    )
