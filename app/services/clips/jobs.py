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
from app.store.jobs import ended_jobs, import_files, outcomes
from app.store.jobs import repository as stored
from app.store.jobs.import_files import FileOutcome, ImportedFile
from app.store.jobs.record import JobKind, JobRecord, JobState

FIRST_FILES = 100
"""Files of an import in its job's result; `list_files` lists all of them."""
FILES_A_PAGE = 1000
JOBS_A_ROUND = 200
FILES_A_ROUND = 5_000
"""Old jobs, and files of theirs, that one transaction removes: other writers must not wait long."""


def get_job(lib: Library, job_id: str) -> JobRecord:
    """A job by id; the result of an import has its first files. Raises JobNotFound."""
    with lib.store.read() as tx:
        return _with_files(tx, stored.get(tx, job_id))


def list_jobs(
    lib: Library,
    kind: JobKind | None = None,
    state: JobState | None = None,
    limit: int = 50,
    cursor: str | None = None,
) -> Page[JobRecord]:
    """One page of jobs, newest first, without imports' files.

    Raises PageNotFound for a bad cursor.
    """
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
    """One page of an import's files, by path; empty for other jobs.

    Raises JobNotFound, PageNotFound for a bad cursor.
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
    """Cancel an open job, which is returned; or remove an ended job, which returns None.

    Raises JobNotFound, Conflict for the newest fit.
    """
    return lib.store.write_even_when_full(lambda tx: _cancel_or_remove(tx, job_id))


def _cancel_or_remove(tx: Tx, job_id: str) -> JobRecord | None:
    if stored.get(tx, job_id).is_open:
        return outcomes.request_cancel(tx, job_id)
    ended_jobs.remove(tx, job_id)
    return None


def remove_old_jobs(lib: Library) -> int:
    """Remove some of the jobs that ended longer ago than `job_retention_days`; returns how many.

    Call it from time to time. A clock that jumps ahead makes every job look old. So one call
    removes only a few jobs, and there is time to correct the clock.
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
    # a result of an earlier version has no conflicts
    problems = (job.result.get(name) for name in ("failed", "absent", "conflicting"))
    has_problems = any(problems)
    files = import_files.first(tx, job.id, FIRST_FILES, has_problems=has_problems)
    left_out = max(job.result["total"] - len(files), 0)
    listed: dict[str, Any] = {"files": [asdict(file) for file in files], "files_left_out": left_out}
    return replace(job, result=job.result | listed)
