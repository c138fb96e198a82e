"""Jobs that have ended: removing one, and those that are old.

The newest fit that succeeded stays: it says what the models know, and when to fit again.
"""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import ScalarSelect, and_, delete, func, select

from app.errors import Conflict
from app.store.database.engine import Tx
from app.store.database.tables import import_entries, jobs
from app.store.jobs import repository as job_repository
from app.store.jobs.record import OPEN_STATES, JobKind, JobState

_OPEN = [state.value for state in OPEN_STATES]


def remove(tx: Tx, job_id: str) -> None:
    """Delete a job that has ended, with what an import recorded of its files; clips stay.

    Raises JobNotFound, and Conflict for a job that is open and for the newest fit.
    """
    job = job_repository.get(tx, job_id)
    if job.is_open:
        raise Conflict("The job has not ended yet.")
    if job_id == tx.execute(select(_newest_fit())).scalar():
        raise Conflict("The newest fit is kept: it says what the models know.")
    tx.execute(delete(jobs).where(jobs.c.id == job_id))


def remove_older(tx: Tx, before: datetime, most_jobs: int, most_files: int) -> int:
    """Delete jobs that ended before a moment, the oldest first; returns how many.

    At most `most_jobs` jobs and `most_files` entries of imports: what is left of an import that
    has more goes with the next calls, and then its job.
    """
    query = (
        select(jobs.c.id)
        .where(jobs.c.state.not_in(_OPEN), jobs.c.finished_at < before)
        .where(jobs.c.id != func.coalesce(_newest_fit(), ""))
        .order_by(jobs.c.finished_at)
        .limit(most_jobs)
    )
    removed, files_left = 0, most_files
    for job_id in tx.execute(query).scalars().all():
        files_left -= _remove_files(tx, job_id, files_left)
        if files_left <= 0:
            break
        removed += tx.execute(delete(jobs).where(jobs.c.id == job_id)).rowcount
    return removed


def _newest_fit() -> ScalarSelect[str]:
    return (
        select(jobs.c.id)
        .where(jobs.c.kind == JobKind.FIT.value, jobs.c.state == JobState.SUCCEEDED.value)
        .order_by(jobs.c.created_at.desc(), jobs.c.id.desc())
        .limit(1)
        .scalar_subquery()
    )


def _remove_files(tx: Tx, job_id: str, most: int) -> int:
    """Delete entries of an import, at most so many; returns how many."""
    of_job = import_entries.c.job_id == job_id
    paths = select(import_entries.c.path).where(of_job).order_by(import_entries.c.path)
    last = tx.execute(paths.offset(most - 1).limit(1)).scalar()
    some = of_job if last is None else and_(of_job, import_entries.c.path <= last)
    return tx.execute(delete(import_entries).where(some)).rowcount
