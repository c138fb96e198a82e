"""Jobs: adds, reads and lists them. `leases` and `queue` give them to workers."""

from __future__ import annotations

from dataclasses import asdict
from datetime import datetime
from typing import Any

from sqlalchemy import RowMapping, Select, bindparam, insert, select

from app.errors import JobNotFound
from app.store import audit
from app.store.clips import versions as library
from app.store.database import signals
from app.store.database.engine import Tx
from app.store.database.ids import new_id, utc_now
from app.store.database.paging import Page, Position, after, read_cursor, write_cursor
from app.store.database.signals import Signal
from app.store.database.tables import jobs
from app.store.database.totals import Total, total_of
from app.store.jobs.record import OPEN_STATES, JobKind, JobRecord, JobState, NewJob

NEWEST_FIRST = "-created_at"

# Built once, because to build a statement takes longer than to execute it.
_ONE = select(jobs).where(jobs.c.id == bindparam("the_id"))
_WITH_KEY = select(jobs).where(jobs.c.dedupe_key == bindparam("the_key"))
_ADD = insert(jobs).returning(jobs)


def enqueue(tx: Tx, new: NewJob) -> JobRecord:
    """Queues a job, or returns the queued one with the same dedupe_key."""
    if new.dedupe_key is not None:
        library.lock(tx)  # so that no other process queues the same key after this query
        queued = tx.execute(_WITH_KEY, {"the_key": new.dedupe_key}).mappings().one_or_none()
        if queued is not None:
            audit.note(job_id=queued["id"])
            return to_record(queued)
    values = asdict(new) | {
        "kind": new.kind.value,
        "id": new_id("job"),
        "state": JobState.QUEUED.value,
        "progress": 0.0,
        "attempts": 0,
        "beats": 0,
        "failures": 0,
        "kills": 0,
        "worker_deaths": 0,
        "cancel_requested": False,
        "created_at": utc_now(),
    }
    job = to_record(tx.execute(_ADD, values).mappings().one())
    audit.note(job_id=job.id)
    signals.send(tx, Signal.QUEUE)
    return job


def get(tx: Tx, job_id: str) -> JobRecord:
    """The job; raises JobNotFound."""
    return to_record(get_row(tx, job_id))


def get_row(tx: Tx, job_id: str) -> RowMapping:
    """The whole row of a job, for other modules of the store; raises JobNotFound."""
    row = tx.execute(_ONE, {"the_id": job_id}).mappings().one_or_none()
    if row is None:
        raise JobNotFound(f"There is no job with the id {job_id!r}")
    return row


def list_jobs(
    tx: Tx,
    *,
    kind: JobKind | None = None,
    state: JobState | None = None,
    limit: int = 50,
    cursor: str | None = None,
) -> Page[JobRecord]:
    """One page of at most `limit` jobs, newest first; raises PageNotFound at "cursor"."""
    query = _filtered(select(jobs), kind, state)
    if cursor is not None:
        position = read_cursor(cursor, NEWEST_FIRST, datetime)
        query = query.where(after(jobs.c.created_at, jobs.c.id, position, descending=True))
    # One row more than the page shows whether there is another page.
    query = query.order_by(jobs.c.created_at.desc(), jobs.c.id.desc()).limit(limit + 1)
    items = [to_record(row) for row in tx.execute(query).mappings()]
    shown = tuple(items[:limit])
    if len(items) <= limit or not shown:
        return Page(shown, None)
    last = Position(shown[-1].created_at, shown[-1].id)
    return Page(shown, write_cursor(NEWEST_FIRST, last))


def total(tx: Tx, *, kind: JobKind | None = None, state: JobState | None = None) -> Total:
    """How many jobs `list_jobs` lists; an estimate if there are many."""
    return total_of(tx, _filtered(select(jobs.c.id), kind, state))


def _filtered(query: Select[Any], kind: JobKind | None, state: JobState | None) -> Select[Any]:
    if kind is not None:
        query = query.where(jobs.c.kind == kind.value)
    if state is not None:
        query = query.where(jobs.c.state == state.value)
    return query


def open_states() -> list[str]:
    """The stored values of the states of jobs that have not ended."""
    return [state.value for state in OPEN_STATES]


def to_record(row: RowMapping) -> JobRecord:
    """A row of `jobs` as a record."""
    return JobRecord(
        id=row["id"],
        kind=JobKind(row["kind"]),
        state=JobState(row["state"]),
        clip_id=row["clip_id"],
        progress=row["progress"],
        detail=row["detail"],
        created_at=row["created_at"],
        started_at=row["started_at"],
        finished_at=row["finished_at"],
        result=row["result"],
        error=row["error"],
    )
