"""Dead workers are found by their missing heartbeats, for any system time."""

from __future__ import annotations

import pytest

from app.store.jobs import leases, outcomes, queue
from app.store.jobs import repository as jobs
from app.store.jobs.abandoned_jobs import HeldJob, Watch
from app.store.jobs.record import ClaimedJob, JobKind, JobState
from app.store.store import Store
from tests.store.conftest import AddJob

LEASE_S = 30.0


class Clock:
    """A monotonic clock that a test moves."""

    def __init__(self) -> None:
        self.now = 1000.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def watch(clock: Clock) -> Watch:
    return Watch("watcher", LEASE_S, clock=clock)


def claim(store: Store, owner: str = "holder") -> ClaimedJob:
    with store.write() as tx:
        claimed = leases.claim(tx, tuple(JobKind), owner)
    assert claimed is not None
    return claimed


def look(store: Store, watch: Watch) -> tuple[HeldJob, ...]:
    with store.read() as tx:
        return watch.look(tx)


def recover(store: Store, watch: Watch) -> list[JobState]:
    abandoned = look(store, watch)
    with store.write() as tx:
        return [job.state for job in queue.recover(tx, watch, abandoned)]


def test_a_job_whose_beats_stop_for_a_lease_goes_back_into_the_queue(
    store: Store, add_job: AddJob, clock: Clock, watch: Watch
) -> None:
    add_job()
    claimed = claim(store)
    assert recover(store, watch) == []
    clock.now += LEASE_S - 1
    assert recover(store, watch) == []
    clock.now += 1
    assert recover(store, watch) == [JobState.QUEUED]
    again = claim(store, "next")
    assert (again.job.id, again.worker_deaths) == (claimed.job.id, 1)


def test_a_worker_with_heartbeats_keeps_its_job(
    store: Store, add_job: AddJob, clock: Clock, watch: Watch
) -> None:
    add_job()
    claimed = claim(store)
    for _ in range(5):
        assert recover(store, watch) == []
        clock.now += LEASE_S - 1
        with store.write() as tx:
            leases.heartbeat(tx, claimed.lease)
    assert recover(store, watch) == []


def test_a_worker_that_sends_a_last_heartbeat_keeps_its_job(
    store: Store, add_job: AddJob, clock: Clock, watch: Watch
) -> None:
    add_job()
    claimed = claim(store)
    look(store, watch)
    clock.now += LEASE_S
    abandoned = look(store, watch)
    assert len(abandoned) == 1
    with store.write() as tx:
        leases.heartbeat(tx, claimed.lease)
    with store.write() as tx:
        assert queue.recover(tx, watch, abandoned) == ()
        assert leases.heartbeat(tx, claimed.lease) is False


def test_only_one_of_two_watchers_gets_the_job(store: Store, add_job: AddJob, clock: Clock) -> None:
    add_job()
    claim(store)
    watches = [Watch(f"watcher {number}", LEASE_S, clock=clock) for number in range(2)]
    for watch in watches:
        look(store, watch)
    clock.now += LEASE_S
    seen = [look(store, watch) for watch in watches]
    with store.write() as tx:
        recovered = [queue.recover(tx, *each) for each in zip(watches, seen, strict=True)]
    assert [len(each) for each in recovered] == [1, 0]


def test_a_watcher_ignores_its_own_jobs_and_parked_jobs(
    store: Store, add_job: AddJob, clock: Clock, watch: Watch
) -> None:
    add_job()
    add_job(JobKind.IMPORT)
    claim(store, "watcher")
    with store.write() as tx:
        parked = leases.claim(tx, [JobKind.IMPORT], "holder")
        assert parked is not None
        leases.park(tx, parked.lease)
    look(store, watch)
    clock.now += 100 * LEASE_S
    assert look(store, watch) == ()


def test_the_job_of_a_dead_worker_is_canceled_within_a_lease(
    store: Store, add_job: AddJob, clock: Clock, watch: Watch
) -> None:
    job = add_job()
    claim(store)
    look(store, watch)
    with store.write() as tx:
        assert outcomes.request_cancel(tx, job.id).state is JobState.PROCESSING
    clock.now += LEASE_S
    assert recover(store, watch) == [JobState.CANCELED]


def test_deaths_without_progress_end_a_job(
    store: Store, add_job: AddJob, clock: Clock, watch: Watch
) -> None:
    job = add_job(max_attempts=3)
    states = []
    for _ in range(3):
        claim(store)
        look(store, watch)
        clock.now += LEASE_S
        states += recover(store, watch)
    assert states == [JobState.QUEUED, JobState.QUEUED, JobState.FAILED]
    with store.read() as tx:
        error = jobs.get(tx, job.id).error
    assert error is not None
    assert (error["code"], "3 times" in error["detail"]) == ("worker_died", True)


def test_deaths_after_progress_do_not_count(
    store: Store, add_job: AddJob, clock: Clock, watch: Watch
) -> None:
    add_job(JobKind.IMPORT, max_attempts=3)
    for _ in range(14):
        claimed = claim(store)
        with store.write() as tx:
            leases.heartbeat(tx, claimed.lease, has_progressed=True)
        look(store, watch)
        clock.now += LEASE_S
        assert recover(store, watch) == [JobState.QUEUED]
