"""Removes jobs that have ended: a single one, or all old ones.

The newest fit that succeeded is never removed: it says on which clips the models were fitted, and
the decision to fit again depends on it.
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
    """Delete a job that has ended. The file entries of an import go too; its clips stay.

    Raises JobNotFound; Conflict for an open job and for the newest fit.
    """
    job = job_repository.get(tx, job_id)
    if job.is_open:
        raise Conflict("The job has not ended yet.")
    if job_id == tx.execute(select(_newest_fit())).scalar():
        raise Conflict("The newest fit cannot be removed: it describes the current models.")
    tx.execute(delete(jobs).where(jobs.c.id == job_id))


def remove_older(tx: Tx, before: datetime, max_jobs: int, max_files: int) -> int:
    """Delete jobs that ended before a time, the oldest first; returns their number.

    max_jobs: jobs in one call; max_files: file entries of imports in one call. If an import has
    more entries, the next calls delete the rest, and the job at the end.
    """
    query = (
        select(jobs.c.id)
        .where(jobs.c.state.not_in(_OPEN), jobs.c.finished_at < before)
        .where(jobs.c.id != func.coalesce(_newest_fit(), ""))
        .order_by(jobs.c.finished_at)
        .limit(max_jobs)
    )
    removed, files_left = 0, max_files
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


def _remove_files(tx: Tx, job_id: str, max_files: int) -> int:
    """Delete the first `max_files` entries of an import, by path; returns their number."""
    of_job = import_entries.c.job_id == job_id
    paths = select(import_entries.c.path).where(of_job).order_by(import_entries.c.path)
    # DELETE has no LIMIT on every database, so the last path to delete is read first.
    last = tx.execute(paths.offset(max_files - 1).limit(1)).scalar()
    some = of_job if last is None else and_(of_job, import_entries.c.path <= last)
    return tx.execute(delete(import_entries).where(some)).rowcount
