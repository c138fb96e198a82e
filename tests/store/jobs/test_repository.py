"""Jobs: adding, keys against duplicates, lists."""

from __future__ import annotations

import pytest

from app.errors import JobNotFound, PageNotFound
from app.store.jobs import leases
from app.store.jobs import repository as jobs
from app.store.jobs.record import JobKind, JobState
from app.store.store import Store
from tests.store.conftest import AddJob


def test_a_queued_job_is_read_as_it_was_added(store: Store, add_job: AddJob) -> None:
    job = add_job(JobKind.IMPORT, payload={"a": [1]})
    with store.read() as tx:
        assert jobs.get(tx, job.id) == job
    assert (job.kind, job.state, job.progress) == (JobKind.IMPORT, JobState.QUEUED, 0.0)
    assert (job.started_at, job.finished_at, job.result, job.error) == (None,) * 4
    assert job.is_open


def test_an_unknown_job(store: Store) -> None:
    with pytest.raises(JobNotFound), store.read() as tx:
        jobs.get(tx, "nothing")


def test_a_fit_is_queued_once_but_may_follow_one_that_runs(store: Store, add_job: AddJob) -> None:
    first = add_job(JobKind.FIT, dedupe_key="fit")
    assert add_job(JobKind.FIT, dedupe_key="fit") == first
    with store.write() as tx:
        leases.claim(tx, [JobKind.FIT], "worker")
    second = add_job(JobKind.FIT, dedupe_key="fit")
    assert second.id != first.id
    assert add_job(JobKind.FIT, dedupe_key="fit") == second


def test_jobs_are_listed_newest_first_page_by_page(store: Store, add_job: AddJob) -> None:
    ids = [add_job().id for _ in range(5)]
    add_job(JobKind.FIT)
    seen: list[str] = []
    cursor = None
    with store.read() as tx:
        while True:
            page = jobs.list_jobs(tx, kind=JobKind.INGEST, limit=2, cursor=cursor)
            seen += [job.id for job in page.items]
            if (cursor := page.next) is None:
                break
        assert jobs.list_jobs(tx, state=JobState.FAILED).items == ()
        with pytest.raises(PageNotFound):
            jobs.list_jobs(tx, cursor="?")
    assert seen == ids[::-1]
