"""Jobs that ended long ago are removed a few at a time, without data that is needed later."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta

from app.store.database.engine import Tx
from app.store.database.ids import utc_now
from app.store.jobs import ended_jobs, imports, leases, outcomes
from app.store.jobs import repository as jobs
from app.store.jobs.import_files import ImportOutcome
from app.store.jobs.imports import NewEntry
from app.store.jobs.record import JobKind, NewJob
from app.store.store import Store

LATER = timedelta(days=40)
MANY = 1000


def _ended(tx: Tx, kind: JobKind, files: int = 0) -> str:
    job = jobs.enqueue(tx, NewJob(kind))
    claimed = leases.claim(tx, [kind], "worker")
    assert claimed is not None
    imports.add_entries(
        tx, job.id, [NewEntry(f"{i:03d}", ImportOutcome.FAILED) for i in range(files)]
    )
    leases.succeed(tx, claimed.lease, {"library_version": 0, "library_size": 0})
    return job.id


def _left(tx: Tx) -> set[str]:
    return {job.id for job in jobs.list_jobs(tx, limit=MANY).items}


def test_old_jobs_are_removed_and_open_and_recent_ones_stay(store: Store) -> None:
    with store.write() as tx:
        old = _ended(tx, JobKind.INGEST)
        open_job = jobs.enqueue(tx, NewJob(JobKind.IMPORT)).id
        assert ended_jobs.remove_older(tx, utc_now() - LATER, MANY, MANY) == 0
        assert ended_jobs.remove_older(tx, utc_now() + LATER, MANY, MANY) == 1
        assert old not in _left(tx)
        assert _left(tx) == {open_job}


def test_the_newest_fit_that_succeeded_stays(store: Store) -> None:
    with store.write() as tx:
        _ended(tx, JobKind.FIT)
        newest = _ended(tx, JobKind.FIT)
        outcomes.request_cancel(tx, jobs.enqueue(tx, NewJob(JobKind.FIT)).id)
        ended_jobs.remove_older(tx, utc_now() + LATER, MANY, MANY)
        assert _left(tx) == {newest}


def test_a_clock_that_jumps_ahead_removes_only_a_few_jobs(store: Store) -> None:
    in_a_year = datetime.now(UTC) + timedelta(days=365)
    with store.write() as tx:
        ids = [_ended(tx, JobKind.INGEST) for _ in range(5)]
        assert ended_jobs.remove_older(tx, in_a_year, 2, MANY) == 2
        assert _left(tx) == set(ids[2:])


def test_a_large_import_is_removed_in_parts_and_its_job_last(store: Store) -> None:
    with store.write() as tx:
        job = _ended(tx, JobKind.IMPORT, files=25)
        for left in (15, 5):
            assert ended_jobs.remove_older(tx, utc_now() + LATER, MANY, 10) == 0
            assert len(imports.recorded_paths(tx, job)) == left
        assert ended_jobs.remove_older(tx, utc_now() + LATER, MANY, 10) == 1
        assert _left(tx) == set()
