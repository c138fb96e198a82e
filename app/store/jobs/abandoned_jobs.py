"""Jobs whose holder is dead: found by watching, without the clock on the wall.

Nobody writes down until when a lease holds: clocks jump, and the clocks of two machines differ.
As in the leader election of Kubernetes, each worker watches what the others hold. Every
heartbeat raises the `beats` of a job. A job whose beats have not changed for a whole lease, by
the watcher's own monotonic clock, is abandoned. The watcher takes it by an UPDATE that demands
exactly what it saw, so that one watcher alone gets it, and none if the holder has come back.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from sqlalchemy import bindparam, select, update

from app.store.database.engine import Tx
from app.store.database.tables import jobs
from app.store.jobs import leases, owners
from app.store.jobs.record import ClaimedJob, JobState


@dataclass(frozen=True, slots=True)
class HeldJob:
    """A job that somebody holds, as it was when it was seen."""

    job_id: str
    owner: str
    attempt: int
    beats: int


class Watch:
    """What one worker has seen of the jobs that others hold."""

    def __init__(
        self,
        me: str,
        lease_s: float,
        *,
        clock: Callable[[], float] = time.monotonic,
        is_gone: Callable[[str], bool] = owners.is_gone,
    ) -> None:
        """`me`: the watcher's own name as an owner."""
        self._me, self._lease_s = me, lease_s
        self._clock, self._is_gone = clock, is_gone
        self._first_seen: dict[HeldJob, float] = {}

    def look(self, tx: Tx) -> tuple[HeldJob, ...]:
        """What others hold and seem to have abandoned; a read."""
        held = [HeldJob(*row) for row in tx.execute(_HELD, {"me": self._me})]
        now = self._clock()
        self._first_seen = {one: self._first_seen.get(one, now) for one in held}
        return tuple(
            one
            for one, seen in self._first_seen.items()
            if now - seen >= self._lease_s or self._is_gone(one.owner)
        )

    def take(self, tx: Tx, held: HeldJob) -> ClaimedJob | None:
        """The job for this watcher, with one more death of its worker; None where it moved on."""
        asked = {
            "the_id": held.job_id,
            "holder": held.owner,
            "attempt": held.attempt,
            "seen": held.beats,
            "me": self._me,
        }
        row = tx.execute(_TAKE, asked).mappings().one_or_none()
        return None if row is None else leases.as_claimed(row)


_HELD = select(jobs.c.id, jobs.c.owner, jobs.c.attempts, jobs.c.beats).where(
    jobs.c.state == JobState.PROCESSING.value,
    jobs.c.owner.is_not(None),
    jobs.c.owner != bindparam("me"),
)
_TAKE = (
    update(jobs)
    .where(
        jobs.c.id == bindparam("the_id"),
        jobs.c.state == JobState.PROCESSING.value,
        jobs.c.owner == bindparam("holder"),
        jobs.c.attempts == bindparam("attempt"),
        jobs.c.beats == bindparam("seen"),
    )
    .values(
        owner=bindparam("me"),
        attempts=jobs.c.attempts + 1,
        beats=0,
        worker_deaths=jobs.c.worker_deaths + 1,
    )
    .returning(jobs)
)
