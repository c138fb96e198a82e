"""Leases: only one worker at a time has a job, as long as it sends heartbeats.

A claim counts an attempt and returns a lease. Every change of a job has its lease (owner and
attempt number) as a condition. So a worker that seemed dead and comes back cannot change a job
that another worker has now. A lease has no end time: `abandoned_jobs` finds jobs of dead workers.
This module does not change clips: `queue` and `outcomes` change jobs and clips together.
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
from app.store.database import signals
from app.store.database.engine import Tx
from app.store.database.ids import utc_now
from app.store.database.signals import Signal
from app.store.database.tables import jobs
from app.store.jobs import endings
from app.store.jobs import repository as job_repository
from app.store.jobs.record import ClaimedJob, JobKind, JobRecord, JobState, Lease

MAX_DELAY_S = 60.0
"""Longest time before the next attempt. If a job would wait longer by the system time, the clock
was set back, and the job is due now."""

_ORDER = (jobs.c.priority, jobs.c.created_at, jobs.c.id)
_FREE: dict[str, Any] = {"owner": None}
_PROGRESS: dict[str, Any] = {"failures": 0, "kills": 0, "worker_deaths": 0}
_NOW = bindparam("now", type_=jobs.c.not_before.type)
_FAR = bindparam("far", type_=jobs.c.not_before.type)


def claim(
    tx: Tx, kinds: Collection[JobKind], owner: str, *, now: datetime | None = None
) -> ClaimedJob | None:
    """Claims the most urgent queued job of these kinds; None if there is none."""
    now = now or utc_now()
    row = tx.execute(_FIRST_QUEUED, _due_parameters(kinds, now)).mappings().one_or_none()
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
        "dedupe_key": None,  # from now on another job with this key may be queued
    }
    return as_claimed(tx.execute(_TAKE, values).mappings().one())


def is_any_claimable(tx: Tx, kinds: Collection[JobKind], *, now: datetime | None = None) -> bool:
    """Whether `claim` would find a job. It only reads, for idle workers."""
    return tx.execute(_FIRST_DUE, _due_parameters(kinds, now or utc_now())).first() is not None


def heartbeat(
    tx: Tx,
    lease: Lease,
    *,
    progress: float | None = None,
    detail: str | None = None,
    has_progressed: bool = False,
) -> bool:
    """Records a heartbeat and the progress; returns whether the job should be canceled.

    progress: completed share, 0..1; has_progressed: a part of the work is done for good, so the
    counters of failures, kills and deaths start again. Raises LeaseLost.
    """
    values: dict[str, Any] = dict(_PROGRESS) if has_progressed else {}
    if progress is not None:
        values["progress"] = min(max(progress, 0.0), 1.0)
    if detail is not None:
        values["detail"] = detail
    return bool(_changed(tx, _BEAT, lease, values)["cancel_requested"])


def succeed(tx: Tx, lease: Lease, result: dict[str, Any] | None = None) -> JobRecord:
    """The job succeeded. Raises LeaseLost if the caller does not have the job any more."""
    return _end(tx, lease, JobState.SUCCEEDED, progress=1.0, result=result)


def fail(tx: Tx, lease: Lease, problem: dict[str, Any]) -> JobRecord:
    """The job failed for good; problem: the reason (RFC 9457). Raises LeaseLost."""
    return _end(tx, lease, JobState.FAILED, error=problem)


def end_canceled(tx: Tx, lease: Lease) -> JobRecord:
    """The job was canceled on request, and its worker has stopped. Raises LeaseLost."""
    return _end(tx, lease, JobState.CANCELED)


def give_back(tx: Tx, lease: Lease) -> JobRecord:
    """Puts the job back into the queue, for example when the worker stops. Raises LeaseLost."""
    values = {"state": JobState.QUEUED.value, "progress": 0.0}
    queued = job_repository.to_record(_change(tx, lease, values | _FREE))
    signals.send(tx, Signal.QUEUE)
    return queued


def retry_later(tx: Tx, lease: Lease, delay_s: float, **counters: int) -> JobRecord:
    """Puts the job back into the queue; it is due after `delay_s` seconds, at most MAX_DELAY_S.

    counters: new values of `failures` or `kills`. Raises LeaseLost.
    """
    later = utc_now() + timedelta(seconds=min(delay_s, MAX_DELAY_S))
    values = {"state": JobState.QUEUED.value, "not_before": later, "progress": 0.0}
    return job_repository.to_record(_change(tx, lease, values | _FREE | counters))


def park(tx: Tx, lease: Lease, detail: str | None = None) -> JobRecord:
    """The worker has done its part, and the job waits for other jobs. Raises LeaseLost.

    Its state stays processing, but it has no owner, so it never counts as abandoned.
    """
    return job_repository.to_record(_change(tx, lease, {"detail": detail} | _FREE))


def as_claimed(row: RowMapping) -> ClaimedJob:
    """A row of `jobs` with an owner, as the claimed job that its worker gets."""
    return ClaimedJob(
        job=job_repository.to_record(row),
        lease=Lease(row["id"], row["owner"], row["attempts"]),
        file_sha256=row["file_sha256"],
        payload=row["payload"],
        max_attempts=row["max_attempts"],
        failures=row["failures"],
        kills=row["kills"],
        worker_deaths=row["worker_deaths"],
        cancel_requested=row["cancel_requested"],
    )


def _due_parameters(kinds: Collection[JobKind], now: datetime) -> dict[str, Any]:
    far = now + timedelta(seconds=MAX_DELAY_S)
    return {"kinds": [kind.value for kind in kinds], "now": now, "far": far}


def _end(tx: Tx, lease: Lease, state: JobState, **values: Any) -> JobRecord:
    values |= {"state": state.value, "finished_at": utc_now()} | _FREE
    ended = _change(tx, lease, values)
    endings.announce(tx, [ended])
    return job_repository.to_record(ended)


def _change(tx: Tx, lease: Lease, values: dict[str, Any]) -> RowMapping:
    return _changed(tx, _CHANGE, lease, values)


def _changed(tx: Tx, change: Update, lease: Lease, values: dict[str, Any]) -> RowMapping:
    condition = {"the_id": lease.job_id, "holder": lease.owner, "attempt": lease.attempt}
    row = tx.execute(change, condition | values).mappings().one_or_none()
    if row is None:
        raise LeaseLost(f"The job {lease.job_id} is over, or was given to another worker")
    return row


def _first(term: ColumnElement[bool]) -> Select[Any]:
    """Selects the most urgent job of some kinds for which `term` is true."""
    of_kinds = jobs.c.kind.in_(bindparam("kinds", expanding=True))
    return select(jobs).where(of_kinds, term).order_by(*_ORDER).limit(1)


# Built once, because to build a statement takes longer than to execute it.
_DUE = and_(
    jobs.c.state == JobState.QUEUED.value,
    or_(jobs.c.not_before.is_(None), jobs.c.not_before <= _NOW, jobs.c.not_before > _FAR),
)
_FIRST_DUE = _first(_DUE)
# skip_locked: PostgreSQL skips a job that another worker is claiming. SQLite has one writer only.
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
