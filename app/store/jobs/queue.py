"""The queue of jobs as a worker uses it: jobs and their clips change together."""

from __future__ import annotations

from collections.abc import Collection

from app.errors import ClipNotFound
from app.store.clips import repository as clips
from app.store.database.engine import Tx
from app.store.jobs import leases, outcomes
from app.store.jobs.abandoned_jobs import HeldJob, Watch
from app.store.jobs.record import ClaimedJob, JobKind, JobRecord


def is_work_waiting(tx: Tx, kinds: Collection[JobKind]) -> bool:
    """Whether `take` would find a job. It only reads, for idle workers."""
    return leases.is_any_claimable(tx, kinds)


def take(tx: Tx, kinds: Collection[JobKind], owner: str) -> ClaimedJob | None:
    """Claims the most urgent job and sets its clip to processing; None if no job waits."""
    while (claimed := leases.claim(tx, kinds, owner)) is not None:
        if claimed.clip_id is None:
            return claimed
        try:
            clips.set_processing(tx, claimed.clip_id)
        except ClipNotFound:  # the clip was deleted, so its job has no purpose
            leases.end_canceled(tx, claimed.lease)
        else:
            return claimed
    return None


def recover(tx: Tx, watch: Watch, abandoned: Collection[HeldJob]) -> tuple[JobRecord, ...]:
    """Ends abandoned jobs or puts them back; skips jobs that changed since `Watch.look`."""
    taken = [watch.take(tx, job) for job in abandoned]
    return tuple(outcomes.recover(tx, claimed) for claimed in taken if claimed is not None)
