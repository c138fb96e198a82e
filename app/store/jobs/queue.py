"""What a worker asks for: the next thing to do."""

from __future__ import annotations

from collections.abc import Collection

from app.errors import ClipNotFound
from app.store.clips import repository as clips
from app.store.database.engine import Tx
from app.store.jobs import leases, outcomes
from app.store.jobs.abandoned_jobs import HeldJob, Watch
from app.store.jobs.record import ClaimedJob, JobKind, JobRecord


def is_work_waiting(tx: Tx, kinds: Collection[JobKind]) -> bool:
    """Whether `take` has something to do; a read, for idle workers."""
    return leases.is_any_claimable(tx, kinds)


def take(tx: Tx, kinds: Collection[JobKind], owner: str) -> ClaimedJob | None:
    """The most urgent job, its clip set to processing; None when nothing waits."""
    while (claimed := leases.claim(tx, kinds, owner)) is not None:
        if claimed.clip_id is None:
            return claimed
        try:
            clips.set_processing(tx, claimed.clip_id)
        except ClipNotFound:
            leases.end_canceled(tx, claimed.lease)
        else:
            return claimed
    return None


def recover(tx: Tx, watch: Watch, abandoned: Collection[HeldJob]) -> tuple[JobRecord, ...]:
    """Ends, or puts back into the queue, those that are still as `Watch.look` saw them."""
    taken = [watch.take(tx, held) for held in abandoned]
    return tuple(outcomes.recover(tx, claimed) for claimed in taken if claimed is not None)
