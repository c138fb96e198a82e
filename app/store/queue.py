"""What a worker asks for: the next thing to do."""

from __future__ import annotations

from collections.abc import Collection

from app.errors import ClipNotFound
from app.store import clips, leases, outcomes
from app.store.engine import Tx
from app.store.job_record import ClaimedJob, JobKind


def is_work_waiting(tx: Tx, kinds: Collection[JobKind]) -> bool:
    """Whether `take` has something to do; a read, for idle workers."""
    return leases.is_any_claimable(tx, kinds)


def take(tx: Tx, kinds: Collection[JobKind], owner: str, lease_s: float) -> ClaimedJob | None:
    """The most urgent job, its clip set to processing; None when nothing waits.

    First it ends what dead workers left beyond hope.
    """
    outcomes.settle_abandoned(tx)
    while (claimed := leases.claim(tx, kinds, owner, lease_s)) is not None:
        if claimed.clip_id is None:
            return claimed
        try:
            clips.set_processing(tx, claimed.clip_id)
        except ClipNotFound:
            leases.end_canceled(tx, claimed.lease)
        else:
            return claimed
    return None
