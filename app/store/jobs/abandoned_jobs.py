"""Finds jobs whose worker is dead by watching their heartbeats, without the system time.

A lease has no end time in the database, because clocks jump, and the clocks of two machines
differ. As in the leader election of Kubernetes, each worker watches the jobs of the others. Every
heartbeat raises the `beats` of a job. If the beats do not change during a whole lease, by the
watcher's own monotonic clock, the job is abandoned. The watcher takes it by an UPDATE with the
values that it saw as conditions. So only one watcher gets the job, and none gets it if its worker
has sent another heartbeat.
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
    """A job of another worker, with the values that a watcher saw."""

    job_id: str
    owner: str
    attempt: int
    beats: int


class Watch:
    """The jobs of other workers, as one worker has seen them over time."""

    def __init__(
        self,
        me: str,
        lease_s: float,
        *,
        clock: Callable[[], float] = time.monotonic,
        is_gone: Callable[[str], bool] = owners.is_gone,
    ) -> None:
        """me: the watcher's own name as an owner; lease_s: seconds without a heartbeat after which
        a job is abandoned; is_gone: whether an owner is certainly dead."""
        self._me, self._lease_s = me, lease_s
        self._clock, self._is_gone = clock, is_gone
        self._first_seen: dict[HeldJob, float] = {}

    def look(self, tx: Tx) -> tuple[HeldJob, ...]:
        """The jobs of other workers that are abandoned now. It only reads."""
        jobs_of_others = [HeldJob(*row) for row in tx.execute(_HELD, {"me": self._me})]
        now = self._clock()
        # `beats` is part of the key, so a heartbeat starts the time of its job again.
        self._first_seen = {one: self._first_seen.get(one, now) for one in jobs_of_others}
        return tuple(
            one
            for one, seen in self._first_seen.items()
            if now - seen >= self._lease_s or self._is_gone(one.owner)
        )

    def take(self, tx: Tx, seen: HeldJob) -> ClaimedJob | None:
        """Gives the job to this watcher and counts a death of its worker.

        Returns None if the job has changed since it was seen.
        """
        parameters = {
            "the_id": seen.job_id,
            "holder": seen.owner,
            "attempt": seen.attempt,
            "seen": seen.beats,
            "me": self._me,
        }
        row = tx.execute(_TAKE, parameters).mappings().one_or_none()
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
