"""Leases: only one worker at a time has a job; if it dies, another worker gets the job."""

from __future__ import annotations

import multiprocessing
import signal
import threading
from collections import Counter
from datetime import timedelta
from pathlib import Path

import pytest

from app.errors import LeaseLost
from app.store.database.ids import utc_now
from app.store.jobs import leases, owners
from app.store.jobs import repository as jobs
from app.store.jobs.abandoned_jobs import Watch
from app.store.jobs.record import ClaimedJob, JobKind, JobState, NewJob
from app.store.store import Store
from tests.store.conftest import AddJob

ALL = tuple(JobKind)


def claim(store: Store, owner: str = "worker", *, after: timedelta = timedelta()) -> ClaimedJob:
    claimed = claim_or_none(store, owner, after=after)
    assert claimed is not None
    return claimed


def claim_or_none(
    store: Store, owner: str = "worker", *, after: timedelta = timedelta()
) -> ClaimedJob | None:
    with store.write() as tx:
        return leases.claim(tx, ALL, owner, now=utc_now() + after)


def take_over(store: Store) -> None:
    """Another worker takes the jobs of their workers, as if these were dead, and puts them back."""
    watch = Watch("watcher", 0.0)
    with store.write() as tx:
        for held in watch.look(tx):
            taken = watch.take(tx, held)
            assert taken is not None
            leases.give_back(tx, taken.lease)


def test_the_most_urgent_comes_first_then_the_oldest(store: Store, add_job: AddJob) -> None:
    old, background, urgent, new = (
        add_job(priority=priority, payload={"n": n}) for n, priority in enumerate((0, 10, -1, 0))
    )
    order = [claim(store) for _ in range(4)]
    assert [each.job.id for each in order] == [urgent.id, old.id, new.id, background.id]
    assert [each.payload["n"] for each in order] == [2, 0, 3, 1]
    assert claim_or_none(store) is None


def test_only_jobs_of_the_requested_kinds_are_claimed(store: Store, add_job: AddJob) -> None:
    add_job(JobKind.FIT)
    with store.write() as tx:
        assert not leases.is_any_claimable(tx, [JobKind.INGEST])
        assert leases.is_any_claimable(tx, [JobKind.FIT])
        assert leases.claim(tx, [JobKind.INGEST], "worker") is None


def test_a_claimed_job_is_processing(store: Store, add_job: AddJob) -> None:
    add_job()
    job = claim(store).job
    assert (job.state, job.finished_at) == (JobState.PROCESSING, None)
    assert job.started_at is not None
    assert job.started_at >= job.created_at


def test_a_heartbeat_records_progress(store: Store, add_job: AddJob) -> None:
    add_job()
    lease = claim(store).lease
    with store.write() as tx:
        canceled = leases.heartbeat(tx, lease, progress=1.5, detail="half")
        leases.heartbeat(tx, lease)
        job = jobs.get(tx, lease.job_id)
        beats = jobs.get_row(tx, lease.job_id)["beats"]
    assert not canceled
    assert (job.progress, job.detail, beats) == (1.0, "half", 2)


def test_a_worker_without_its_lease_can_settle_nothing(store: Store, add_job: AddJob) -> None:
    add_job()
    slow = claim(store, "slow").lease
    take_over(store)
    quick = claim(store, "quick").lease
    assert quick.attempt > slow.attempt
    settlers = [
        lambda tx, lease: leases.succeed(tx, lease),
        lambda tx, lease: leases.fail(tx, lease, {}),
        lambda tx, lease: leases.heartbeat(tx, lease),
        leases.give_back,
        leases.park,
        leases.end_canceled,
        lambda tx, lease: leases.retry_later(tx, lease, 1),
    ]
    for settle in settlers:
        with pytest.raises(LeaseLost), store.write() as tx:
            settle(tx, slow)
    with store.write() as tx:
        done = leases.succeed(tx, quick, {"n": 1})
    assert (done.state, done.progress, done.result) == (JobState.SUCCEEDED, 1.0, {"n": 1})
    with pytest.raises(LeaseLost), store.write() as tx:
        leases.succeed(tx, quick)


def test_the_same_worker_has_to_claim_again_too(store: Store, add_job: AddJob) -> None:
    add_job()
    first = claim(store).lease
    take_over(store)
    claim(store)
    with pytest.raises(LeaseLost), store.write() as tx:
        leases.succeed(tx, first)


def test_a_job_given_back_can_be_claimed_at_once(store: Store, add_job: AddJob) -> None:
    add_job(max_attempts=1)
    for _ in range(3):
        lease = claim(store).lease
        with store.write() as tx:
            assert leases.give_back(tx, lease).state is JobState.QUEUED


def test_a_job_to_be_retried_waits_and_counts(store: Store, add_job: AddJob) -> None:
    add_job()
    with store.write() as tx:
        leases.retry_later(tx, claim_in(tx), delay_s=60)
    assert claim_or_none(store) is None
    with store.read() as tx:
        assert not leases.is_any_claimable(tx, ALL)
    assert claim(store, after=timedelta(seconds=61)).lease.attempt == 2


@pytest.mark.parametrize("ahead", [timedelta(hours=1), timedelta(days=400)])
def test_a_clock_that_is_set_back_does_not_hold_up_a_retry(
    store: Store, add_job: AddJob, ahead: timedelta
) -> None:
    add_job()
    with store.write() as tx:
        leases.retry_later(tx, claim_in(tx), delay_s=5)
    with store.read() as tx:
        assert leases.is_any_claimable(tx, ALL, now=utc_now() - ahead)
    assert claim_or_none(store, after=-ahead) is not None


def claim_in(tx: leases.Tx) -> leases.Lease:
    claimed = leases.claim(tx, ALL, "worker")
    assert claimed is not None
    return claimed.lease


def queue_many(store: Store, count: int) -> list[str]:
    with store.write() as tx:
        new = NewJob(JobKind.INGEST, max_attempts=1)
        return [jobs.enqueue(tx, new).id for _ in range(count)]


def test_threads_claim_each_job_once(store: Store) -> None:
    expected = set(queue_many(store, 20))
    taken: Counter[str] = Counter()

    def work(owner: str) -> None:
        while (claimed := claim_or_none(store, owner)) is not None:
            taken[claimed.job.id] += 1

    threads = [threading.Thread(target=work, args=(f"worker {n}",)) for n in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert taken == dict.fromkeys(expected, 1)


def _claim_all(url: str, directory: Path, owner: str) -> None:
    store = Store.open(url, directory)
    while (claimed := claim_or_none(store, owner)) is not None:
        with store.write() as tx:
            leases.succeed(tx, claimed.lease, {"by": owner})
    store.close()


def test_processes_claim_each_job_once(store: Store, database_url: str, tmp_path: Path) -> None:
    ids = queue_many(store, 20)
    spawn = multiprocessing.get_context("spawn")
    processes = [
        spawn.Process(target=_claim_all, args=(database_url, tmp_path, f"worker {n}"))
        for n in range(2)
    ]
    for process in processes:
        process.start()
    for process in processes:
        process.join(300)
    # If two workers had claimed the same job, one of them would have raised LeaseLost.
    assert [process.exitcode for process in processes] == [0, 0]
    with store.read() as tx:
        assert {jobs.get(tx, job_id).state for job_id in ids} == {JobState.SUCCEEDED}


def _claim_and_die(url: str, directory: Path) -> None:
    store = Store.open(url, directory)
    with store.write() as tx:
        leases.claim(tx, ALL, owners.new_owner("doomed"))
    with store.write() as tx:  # dies inside a write transaction too
        tx.exec_driver_sql("UPDATE jobs SET detail = 'torn'")
        signal.raise_signal(signal.SIGKILL)


def test_a_worker_killed_on_this_machine_is_seen_as_dead_at_once(
    store: Store, database_url: str, tmp_path: Path, add_job: AddJob
) -> None:
    job = add_job()
    spawn = multiprocessing.get_context("spawn")
    process = spawn.Process(target=_claim_and_die, args=(database_url, tmp_path))
    process.start()
    process.join(300)
    assert process.exitcode == -signal.SIGKILL
    with store.read() as tx:
        left = jobs.get(tx, job.id)
    assert (left.state, left.detail) == (JobState.PROCESSING, None)
    watch = Watch("next", lease_s=3600.0)
    with store.write() as tx:
        (held,) = watch.look(tx)
        taken = watch.take(tx, held)
    assert taken is not None
    assert (taken.job.id, taken.worker_deaths) == (job.id, 1)
