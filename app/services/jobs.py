"""Jobs: look up, list, cancel."""

from __future__ import annotations

from app.services.library import Library
from app.store import jobs as stored
from app.store import outcomes
from app.store.job_record import JobKind, JobRecord, JobState
from app.store.paging import Page


def get_job(lib: Library, job_id: str) -> JobRecord:
    """A job by id; raises JobNotFound."""
    with lib.store.read() as tx:
        return stored.get(tx, job_id)


def list_jobs(
    lib: Library,
    kind: JobKind | None = None,
    state: JobState | None = None,
    limit: int = 50,
    cursor: str | None = None,
) -> Page[JobRecord]:
    """One page of jobs, newest first. Raises BadField for a bad cursor."""
    with lib.store.read() as tx:
        return stored.list_jobs(tx, kind=kind, state=state, limit=limit, cursor=cursor)


def cancel_job(lib: Library, job_id: str) -> JobRecord:
    """Ask a job to stop; one that has ended stays as it is. Raises JobNotFound."""
    return lib.store.write_even_when_full(lambda tx: outcomes.request_cancel(tx, job_id))
