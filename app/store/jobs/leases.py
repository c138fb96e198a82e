"""Leases: one worker at a time has a job, for as long as its heart beats.

A claim counts an attempt and gives a lease. Whatever a worker does with a job is guarded by its
lease (owner and attempt), so that a worker that was thought dead and comes back changes nothing.
No lease has an end on the clock: `abandoned` finds those whose holder is dead. Nothing here
touches clips: `queue` and `outcomes` join the two.
"""

from __future__ import annotations

from collections.abc import Collection
from datetime import datetime, timedelta
from typing import Any

from sqlalchemy import (
    ColumnElement,
    RowMapping,
    Select,
    Update,
    and_,
    bindparam,
    or_,
    select,
    update,
)

from app.errors import LeaseLost
from app.store.database.engine import Tx
from app.store.database.ids import utc_now
from app.store.database.tables import jobs
from app.store.jobs import endings
from app.store.jobs import repository as job_repository
from app.store.jobs.record import ClaimedJob, JobKind, JobRecord, JobState, Lease

LONGEST_DELAY_S = 60.0
"""No job waits longer for its next try. One that is to wait longer by the clock on the wall is
due at once: then the clock was set back."""

_ORDER = (jobs.c.priority, jobs.c.created_at, jobs.c.id)
_FREE: dict[str, Any] = {"owner": None}
_PROGRESS: dict[str, Any] = {"failures": 0, "kills": 0, "worker_deaths": 0}
_NOW = bindparam("now", type_=jobs.c.not_before.type)
_FAR = bindparam("far", type_=jobs.c.not_before.type)


def claim(
    tx: Tx, kinds: Collection[JobKind], owner: str, *, now: datetime | None = None
) -> ClaimedJob | None:
    """Takes the most urgent job that is queued; None when there is none."""
    now = now or utc_now()
    row = tx.execute(_FIRST_QUEUED, _asked(kinds, now)).mappings().one_or_none()
    if row is None:
        return None
    values = {
        "the_id": row["id"],
        "state": JobState.PROCESSING.value,
        "owner": owner,
        "beats": 0,
        "attempts": row["attempts"] + 1,
        "started_at": row["started_at"] or now,
        "not_before": None,
        "dedupe_key": None,  # from now on another of its kind may be queued
    }
    return as_claimed(tx.execute(_TAKE, values).mappings().one())


def is_any_claimable(tx: Tx, kinds: Collection[JobKind], *, now: datetime | None = None) -> bool:
    """Whether `claim` would find something: cheap, so that an idle worker need not write."""
    return tx.execute(_FIRST_DUE, _asked(kinds, now or utc_now())).first() is not None


def heartbeat(
    tx: Tx,
    lease: Lease,
    *,
    progress: float | None = None,
    detail: str | None = None,
    has_progressed: bool = False,
) -> bool:
    """Shows that the holder lives and how far the work is; True when the job is to be canceled.

    has_progressed: some of the work is done and need not be done again, so that what went wrong
    before does not count any more.
    """
    values: dict[str, Any] = dict(_PROGRESS) if has_progressed else {}
    if progress is not None:
        values["progress"] = min(max(progress, 0.0), 1.0)
    if detail is not None:
        values["detail"] = detail
    return bool(_changed(tx, _BEAT, lease, values)["cancel_requested"])


def succeed(tx: Tx, lease: Lease, result: dict[str, Any] | None = None) -> JobRecord:
    """The job is done. Raises LeaseLost, as all below, when the job is no longer the caller's."""
    return _end(tx, lease, JobState.SUCCEEDED, progress=1.0, result=result)


def fail(tx: Tx, lease: Lease, problem: dict[str, Any]) -> JobRecord:
    """The job is given up, for the reason given as an RFC 9457 problem."""
    return _end(tx, lease, JobState.FAILED, error=problem)


def end_canceled(tx: Tx, lease: Lease) -> JobRecord:
    """The worker has stopped because it was asked to."""
    return _end(tx, lease, JobState.CANCELED)


def give_back(tx: Tx, lease: Lease) -> JobRecord:
    """Back into the queue: the worker shuts down, or did half and leaves the rest for later."""
    values = {"state": JobState.QUEUED.value, "progress": 0.0}
    return job_repository.to_record(_change(tx, lease, values | _FREE))


def retry_later(tx: Tx, lease: Lease, delay_s: float, **counters: int) -> JobRecord:
    """Back into the queue for a while, at most LONGEST_DELAY_S.

    counters: new values of `failures` or `kills`.
    """
    later = utc_now() + timedelta(seconds=min(delay_s, LONGEST_DELAY_S))
    values = {"state": JobState.QUEUED.value, "not_before": later, "progress": 0.0}
    return job_repository.to_record(_change(tx, lease, values | _FREE | counters))


def park(tx: Tx, lease: Lease, detail: str | None = None) -> JobRecord:
    """The worker is done, the job waits for others: processing, but nobody's, never abandoned."""
    return job_repository.to_record(_change(tx, lease, {"detail": detail} | _FREE))


def as_claimed(row: RowMapping) -> ClaimedJob:
    """A row of `jobs` that its owner has, as what a worker gets."""
    return ClaimedJob(
        job=job_repository.to_record(row),
        lease=Lease(row["id"], row["owner"], row["attempts"]),
        clip_id=row["clip_id"],
        file_sha256=row["file_sha256"],
        payload=row["payload"],
        max_attempts=row["max_attempts"],
        failures=row["failures"],
        kills=row["kills"],
        worker_deaths=row["worker_deaths"],
        cancel_requested=row["cancel_requested"],
    )


def _asked(kinds: Collection[JobKind], now: datetime) -> dict[str, Any]:
    far = now + timedelta(seconds=LONGEST_DELAY_S)
    return {"kinds": [kind.value for kind in kinds], "now": now, "far": far}


def _end(tx: Tx, lease: Lease, state: JobState, **values: Any) -> JobRecord:
    values |= {"state": state.value, "finished_at": utc_now()} | _FREE
    ended = _change(tx, lease, values)
    endings.announce(tx, [ended])
    return job_repository.to_record(ended)


def _change(tx: Tx, lease: Lease, values: dict[str, Any]) -> RowMapping:
    return _changed(tx, _CHANGE, lease, values)


def _changed(tx: Tx, change: Update, lease: Lease, values: dict[str, Any]) -> RowMapping:
    held = {"the_id": lease.job_id, "holder": lease.owner, "attempt": lease.attempt}
    row = tx.execute(change, held | values).mappings().one_or_none()
    if row is None:
        raise LeaseLost(f"The job {lease.job_id} is over, or was given to another worker")
    return row


def _first(term: ColumnElement[bool]) -> Select[Any]:
    """The most urgent job of the kinds asked for, of which `term` holds."""
    of_kinds = jobs.c.kind.in_(bindparam("kinds", expanding=True))
    return select(jobs).where(of_kinds, term).order_by(*_ORDER).limit(1)


# The statements of every claim and every step, made once: making them costs more than running.
_DUE = and_(
    jobs.c.state == JobState.QUEUED.value,
    or_(jobs.c.not_before.is_(None), jobs.c.not_before <= _NOW, jobs.c.not_before > _FAR),
)
_FIRST_DUE = _first(_DUE)
# skip_locked: on PostgreSQL workers pass each other; SQLite's writers take turns anyway.
_FIRST_QUEUED = _FIRST_DUE.with_for_update(skip_locked=True)
_TAKE = update(jobs).where(jobs.c.id == bindparam("the_id")).returning(jobs)
_CHANGE = (
    update(jobs)
    .where(
        jobs.c.id == bindparam("the_id"),
        jobs.c.state == JobState.PROCESSING.value,
        jobs.c.owner == bindparam("holder"),
        jobs.c.attempts == bindparam("attempt"),
    )
    .returning(jobs)
)
_BEAT = _CHANGE.values(beats=jobs.c.beats + 1)
