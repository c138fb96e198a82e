"""Jobs: look up, list, read an import's files, cancel, remove, and forget the old ones."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, replace
from datetime import timedelta
from typing import Any

from app.services.library.library import Library
from app.store.database.engine import Tx
from app.store.database.ids import utc_now
from app.store.database.paging import Page
from app.store.jobs import ended as ended_jobs
from app.store.jobs import import_files, outcomes
from app.store.jobs import repository as stored
from app.store.jobs.import_files import FileOutcome, ImportedFile
from app.store.jobs.record import JobKind, JobRecord, JobState

FIRST_FILES = 100
"""Files of an import in its job's result; `list_files` lists all of them."""
FILES_A_PAGE = 1000
JOBS_A_ROUND = 200
FILES_A_ROUND = 5_000
"""What is removed of old jobs in one transaction: others must not wait for it."""


def get_job(lib: Library, job_id: str) -> JobRecord:
    """A job by id, an import's result with its first files; raises JobNotFound."""
    with lib.store.read() as tx:
        return _with_files(tx, stored.get(tx, job_id))


def list_jobs(
    lib: Library,
    kind: JobKind | None = None,
    state: JobState | None = None,
    limit: int = 50,
    cursor: str | None = None,
) -> Page[JobRecord]:
    """One page of jobs, newest first, without imports' files. Raises BadField for a bad cursor."""
    with lib.store.read() as tx:
        page = stored.list_jobs(tx, kind=kind, state=state, limit=limit, cursor=cursor)
        return page.counted(stored.total(tx, kind=kind, state=state))


def list_files(
    lib: Library,
    job_id: str,
    outcome: FileOutcome | None = None,
    limit: int = 50,
    cursor: str | None = None,
) -> Page[ImportedFile]:
    """One page of an import's files, by path; of any other job there are none.

    Raises JobNotFound, BadField for a bad cursor.
    """
    with lib.store.read() as tx:
        stored.get(tx, job_id)
        page = import_files.page(tx, job_id, outcome=outcome, limit=limit, cursor=cursor)
        return page.counted(import_files.total(tx, job_id, outcome))


def all_files(
    lib: Library, job_id: str, outcome: FileOutcome | None = None
) -> Iterator[ImportedFile]:
    """Every file of an import, by path. Raises JobNotFound."""
    cursor = None
    while True:
        page = list_files(lib, job_id, outcome, FILES_A_PAGE, cursor)
        yield from page.items
        cursor = page.next
        if cursor is None:
            return


def cancel_or_remove(lib: Library, job_id: str) -> JobRecord | None:
    """Ask an open job to stop; remove one that has ended, which returns None.

    Raises JobNotFound, Conflict for the newest fit.
    """
    return lib.store.write_even_when_full(lambda tx: _cancel_or_remove(tx, job_id))


def _cancel_or_remove(tx: Tx, job_id: str) -> JobRecord | None:
    if stored.get(tx, job_id).is_open:
        return outcomes.request_cancel(tx, job_id)
    ended_jobs.remove(tx, job_id)
    return None


def remove_old_jobs(lib: Library) -> int:
    """Remove some of the jobs that ended longer ago than the settings keep them; how many.

    Call it now and then. A clock that jumps ahead makes every job look old: a call removes a few
    of them only, so that they do not all go before somebody sets the clock right.
    """
    days = lib.settings.job_retention_days
    if not days:
        return 0
    with lib.store.write() as tx:
        before = utc_now() - timedelta(days=days)
        return ended_jobs.remove_older(tx, before, JOBS_A_ROUND, FILES_A_ROUND)


def _with_files(tx: Tx, job: JobRecord) -> JobRecord:
    if job.kind is not JobKind.IMPORT or job.result is None:
        return job
    has_problems = bool(job.result["failed"] or job.result["absent"])
    files = import_files.first(tx, job.id, FIRST_FILES, has_problems=has_problems)
    left_out = max(job.result["total"] - len(files), 0)
    listed: dict[str, Any] = {"files": [asdict(file) for file in files], "files_left_out": left_out}
    return replace(job, result=job.result | listed)
