"""Leases: one worker at a time has a job, for as long as its heart beats.

A claim counts an attempt and gives a lease; a lease that is not renewed expires and the job can
be claimed again. Whatever a worker does with a job is guarded by its lease (owner and attempt),
so one that was thought dead and comes back changes nothing. Nothing here touches clips: `queue`
and `outcomes` join the two.
"""

from __future__ import annotations

from collections.abc import Collection
from datetime import datetime, timedelta
from typing import Any

from sqlalchemy import ColumnElement, RowMapping, Select, and_, bindparam, or_, select, update

from app.errors import LeaseLost
from app.store import jobs as job_repository
from app.store.engine import Tx
from app.store.ids import utc_now
from app.store.job_record import ClaimedJob, JobKind, JobRecord, JobState, Lease
from app.store.tables import jobs

_ORDER = (jobs.c.priority, jobs.c.created_at, jobs.c.id)
_FREE: dict[str, Any] = {"owner": None, "lease_until": None}
_NOW = bindparam("now", type_=jobs.c.not_before.type)


def claim(
    tx: Tx,
    kinds: Collection[JobKind],
    owner: str,
    lease_s: float,
    *,
    now: datetime | None = None,
) -> ClaimedJob | None:
    """Takes the most urgent job that is queued or abandoned; None when there is none."""
    now = now or utc_now()
    asked = _asked(kinds, now)
    found = [
        row
        for query in (_FIRST_QUEUED, _FIRST_ABANDONED)
        if (row := tx.execute(query, asked).mappings().one_or_none())
    ]
    if not found:
        return None
    row = min(found, key=lambda each: (each["priority"], each["created_at"], each["id"]))
    values = {
        "the_id": row["id"],
        "state": JobState.PROCESSING.value,
        "owner": owner,
        "lease_until": now + timedelta(seconds=lease_s),
        "attempts": row["attempts"] + 1,
        "started_at": row["started_at"] or now,
        "not_before": None,
        "dedupe_key": None,  # from now on another of its kind may be queued
    }
    return _as_claimed(tx.execute(_TAKE, values).mappings().one())


def is_any_claimable(tx: Tx, kinds: Collection[JobKind], *, now: datetime | None = None) -> bool:
    """Whether `claim` would find something: cheap, so that an idle worker need not write."""
    now = now or utc_now()
    asked = _asked(kinds, now)
    queries = (_FIRST_QUEUED, _FIRST_EXPIRED)
    return any(tx.execute(query, asked).first() is not None for query in queries)


def exhausted(tx: Tx, *, now: datetime | None = None) -> tuple[ClaimedJob, ...]:
    """Abandoned jobs that may not be tried again, because of their attempts or a cancellation."""
    now = now or utc_now()
    return tuple(_as_claimed(row) for row in tx.execute(_SPENT, {"now": now}).mappings())


def heartbeat(
    tx: Tx,
    lease: Lease,
    lease_s: float,
    *,
    progress: float | None = None,
    detail: str | None = None,
    now: datetime | None = None,
) -> bool:
    """Renews the lease and tells how far the work is; True when the job is to be canceled."""
    values: dict[str, Any] = {"lease_until": (now or utc_now()) + timedelta(seconds=lease_s)}
    if progress is not None:
        values["progress"] = min(max(progress, 0.0), 1.0)
    if detail is not None:
        values["detail"] = detail
    return bool(_change(tx, lease, values)["cancel_requested"])


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
    """Back into the queue as if it had not been tried: the worker is shutting down."""
    values = {"state": JobState.QUEUED.value, "attempts": lease.attempt - 1, "progress": 0.0}
    return job_repository.to_record(_change(tx, lease, values | _FREE))


def retry_later(tx: Tx, lease: Lease, delay_s: float) -> JobRecord:
    """Back into the queue for a while; the attempt counts."""
    later = utc_now() + timedelta(seconds=delay_s)
    values = {"state": JobState.QUEUED.value, "not_before": later, "progress": 0.0}
    return job_repository.to_record(_change(tx, lease, values | _FREE))


def park(tx: Tx, lease: Lease, detail: str | None = None) -> JobRecord:
    """The worker is done, the job waits for others: processing, but nobody's, never expiring."""
    return job_repository.to_record(_change(tx, lease, {"detail": detail} | _FREE))


def _asked(kinds: Collection[JobKind], now: datetime) -> dict[str, Any]:
    return {"kinds": [kind.value for kind in kinds], "now": now}


def _end(tx: Tx, lease: Lease, state: JobState, **values: Any) -> JobRecord:
    values |= {"state": state.value, "finished_at": utc_now()} | _FREE
    return job_repository.to_record(_change(tx, lease, values))


def _change(tx: Tx, lease: Lease, values: dict[str, Any]) -> RowMapping:
    held = {"the_id": lease.job_id, "holder": lease.owner, "attempt": lease.attempt}
    row = tx.execute(_CHANGE, held | values).mappings().one_or_none()
    if row is None:
        raise LeaseLost(f"The job {lease.job_id} is over, or was given to another worker")
    return row


def _as_claimed(row: RowMapping) -> ClaimedJob:
    return ClaimedJob(
        job=job_repository.to_record(row),
        lease=Lease(row["id"], row["owner"], row["attempts"]),
        clip_id=row["clip_id"],
        file_sha256=row["file_sha256"],
        payload=row["payload"],
    )


def _first(term: ColumnElement[bool]) -> Select[Any]:
    """The most urgent job of the kinds asked for, of which `term` holds."""
    of_kinds = jobs.c.kind.in_(bindparam("kinds", expanding=True))
    return select(jobs).where(of_kinds, term).order_by(*_ORDER).limit(1)


# The statements of every claim and every step, made once: making them costs more than running.
_DUE = and_(
    jobs.c.state == JobState.QUEUED.value,
    or_(jobs.c.not_before.is_(None), jobs.c.not_before <= _NOW),
)
_EXPIRED = and_(jobs.c.state == JobState.PROCESSING.value, jobs.c.lease_until < _NOW)
_MAY_TRY_AGAIN = and_(jobs.c.attempts < jobs.c.max_attempts, jobs.c.cancel_requested.is_(False))
_IS_SPENT = or_(jobs.c.attempts >= jobs.c.max_attempts, jobs.c.cancel_requested)

_FIRST_EXPIRED = _first(_EXPIRED)
# skip_locked: on PostgreSQL workers pass each other; SQLite's writers take turns anyway.
_FIRST_QUEUED = _first(_DUE).with_for_update(skip_locked=True)
_FIRST_ABANDONED = _first(and_(_EXPIRED, _MAY_TRY_AGAIN)).with_for_update(skip_locked=True)
_SPENT = select(jobs).where(_EXPIRED, _IS_SPENT).with_for_update(skip_locked=True)
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
