"""The outcomes of jobs: job, clip and import end together, and each clip ends once."""

from __future__ import annotations

from datetime import timedelta

import pytest

from app.errors import LeaseLost
from app.store.clips import arrays
from app.store.clips import repository as clips
from app.store.clips import versions as library
from app.store.clips.record import ClipRecord, ClipState
from app.store.database.engine import Tx
from app.store.jobs import import_files, imports, leases, outcomes, owners, queue
from app.store.jobs import repository as jobs
from app.store.jobs.imports import ImportOutcome, NewEntry
from app.store.jobs.record import ClaimedJob, JobKind, JobRecord, JobState, NewJob
from app.store.store import Store
from tests.store.conftest import facts
from tests.store.queued import ALL, FOUND, PROBLEM, add, die, states, take
from tests.store.stored_arrays import array_versions


def test_a_taken_clip_is_processing_and_then_ready(store: Store) -> None:
    with store.write() as tx:
        clip = add(tx, "walk")
        assert queue.is_work_waiting(tx, ALL)
        claimed = take(tx)
        assert claimed.clip_id == clip.id
        assert states(tx, clip, claimed) == (ClipState.PROCESSING, JobState.PROCESSING)
    with store.write() as tx:
        outcomes.finish_ingest(tx, claimed.lease, clip.id, facts(), FOUND)
    with store.write() as tx:
        assert states(tx, clip, claimed) == (ClipState.READY, JobState.SUCCEEDED)
        assert library.changed_since(tx, 0).changed == (clip.id,)
        assert arrays.get_one(tx, clip.id, "motion_vector").shape == (128,)
        assert queue.take(tx, ALL, "worker") is None


def test_bad_content_fails_both(store: Store) -> None:
    with store.write() as tx:
        clip = add(tx, "walk")
        claimed = take(tx)
        outcomes.fail_job(tx, claimed, PROBLEM)
        assert states(tx, clip, claimed) == (ClipState.FAILED, JobState.FAILED)
        assert clips.get(tx, clip.id).error == jobs.get(tx, claimed.job.id).error == PROBLEM


def test_a_worker_that_lost_its_lease_changes_nothing(store: Store) -> None:
    with store.write() as tx:
        clip = add(tx, "walk")
        late = take(tx)
        die(tx)
        current = take(tx)
    for settle in (
        lambda tx: outcomes.finish_ingest(tx, late.lease, clip.id, facts(), FOUND),
        lambda tx: outcomes.fail_job(tx, late, PROBLEM),
        lambda tx: outcomes.give_back(tx, late),
    ):
        with pytest.raises(LeaseLost), store.write() as tx:
            settle(tx)
    with store.read() as tx:
        assert states(tx, clip, current) == (ClipState.PROCESSING, JobState.PROCESSING)
        assert array_versions(tx, clip.id) == {}
        assert library.version(tx) == 0


def test_a_clip_that_kills_its_workers_is_given_up(store: Store) -> None:
    with store.write() as tx:
        clip = add(tx, "poison", max_attempts=3)
        for _ in range(3):
            claimed = take(tx)
            die(tx)
        assert not queue.is_work_waiting(tx, ALL)
        error = clips.get(tx, clip.id).error
        assert states(tx, clip, claimed) == (ClipState.FAILED, JobState.FAILED)
    assert error is not None
    assert error["code"] == "worker_died"
    assert "died 3 times" in error["detail"]


def test_temporary_failures_are_tried_again_and_then_end_the_job(store: Store) -> None:
    with store.write() as tx:
        clip = add(tx, "walk", max_attempts=2)
        claimed = take(tx)
        outcomes.retry_or_fail(tx, claimed, PROBLEM, delay_s=-1)
        assert states(tx, clip, claimed) == (ClipState.QUEUED, JobState.QUEUED)
        outcomes.retry_or_fail(tx, take(tx), PROBLEM, delay_s=-1)
        assert states(tx, clip, claimed) == (ClipState.FAILED, JobState.FAILED)


def test_a_worker_that_stops_puts_its_clip_back(store: Store) -> None:
    with store.write() as tx:
        clip = add(tx, "walk", max_attempts=1)
        for _ in range(3):
            outcomes.give_back(tx, claimed := take(tx))
            assert states(tx, clip, claimed) == (ClipState.QUEUED, JobState.QUEUED)


def test_cancel_a_queued_job(store: Store) -> None:
    with store.write() as tx:
        clip = add(tx, "walk")
        (job,) = jobs.list_jobs(tx).items
        assert outcomes.request_cancel(tx, job.id).state is JobState.CANCELED
        failed = clips.get(tx, clip.id)
        assert failed.error is not None
        assert (failed.state, failed.error["code"]) == (ClipState.FAILED, "canceled")
        assert queue.take(tx, ALL, "worker") is None


def test_cancel_a_job_that_runs(store: Store) -> None:
    with store.write() as tx:
        clip = add(tx, "walk")
        claimed = take(tx)
        assert outcomes.request_cancel(tx, claimed.job.id).state is JobState.PROCESSING
        assert leases.heartbeat(tx, claimed.lease)
        outcomes.finish_canceled(tx, claimed)
        assert states(tx, clip, claimed) == (ClipState.FAILED, JobState.CANCELED)
        over = jobs.get(tx, claimed.job.id)
        assert outcomes.request_cancel(tx, over.id) == over


def test_cancel_a_job_whose_worker_died(store: Store) -> None:
    with store.write() as tx:
        clip = add(tx, "walk")
        claimed = take(tx)
        assert outcomes.request_cancel(tx, claimed.job.id).state is JobState.PROCESSING
        die(tx)
        assert states(tx, clip, claimed) == (ClipState.FAILED, JobState.CANCELED)


def test_a_removed_clip_ends_its_job(store: Store) -> None:
    with store.write() as tx:
        clip, running = add(tx, "walk"), take(tx)
        waiting = add(tx, "run")
        for each in (clip, waiting):
            outcomes.remove_clip(tx, each.id)
        assert jobs.get(tx, running.job.id).state is JobState.CANCELED
        assert queue.take(tx, ALL, "worker") is None
    with pytest.raises(LeaseLost), store.write() as tx:
        outcomes.finish_ingest(tx, running.lease, clip.id, facts(), FOUND)


def start_import(tx: Tx, *names: str) -> tuple[JobRecord, list[ClipRecord]]:
    """An import that has unpacked these clips and one bad file, and waits for the clips."""
    job = jobs.enqueue(tx, NewJob(JobKind.IMPORT, priority=-1))
    claimed = take(tx)
    assert claimed.job.id == job.id
    added = []
    for name in names:
        clip = add(tx, name)
        imports.add_entries(
            tx, job.id, [NewEntry(f"{name}.bvh", ImportOutcome.QUEUED, clip_id=clip.id)]
        )
        added.append(clip)
    imports.add_entries(tx, job.id, [NewEntry("z.txt", ImportOutcome.FAILED, problem=PROBLEM)])
    return imports.wait_for_clips(tx, claimed.lease), added


def test_an_import_ends_with_the_last_of_its_clips(store: Store) -> None:
    with store.write() as tx:
        job, (good, bad, gone) = start_import(tx, "a", "b", "c")
        assert (job.state, job.progress) == (JobState.PROCESSING, 0.25)
        outcomes.finish_ingest(tx, take(tx).lease, good.id, facts(), FOUND)
        outcomes.fail_job(tx, take(tx), PROBLEM)
        assert jobs.get(tx, job.id).progress == 0.75
        outcomes.remove_clip(tx, gone.id)
        done = jobs.get(tx, job.id)
    assert (done.state, done.progress) == (JobState.SUCCEEDED, 1.0)
    assert done.finished_at is not None
    assert done.result == {
        "total": 4,
        "new": 1,
        "updated": 0,
        "unchanged": 0,
        "conflicting": 0,
        "failed": 2,
        "skipped": 0,
        "deleted": 1,
        "absent": 0,
        "unmatched": 0,
        "warnings": {"frame_rate_suspect": 1},
    }
    with store.read() as tx:
        files = import_files.page(tx, job.id).items
    assert [(f.path, f.outcome, f.clip_id, f.error) for f in files] == [
        ("a.bvh", "ready", good.id, None),
        ("b.bvh", "failed", bad.id, PROBLEM),
        ("c.bvh", "deleted", None, None),
        ("z.txt", "failed", None, PROBLEM),
    ]


def test_an_import_with_nothing_to_wait_for_ends_at_once(store: Store) -> None:
    with store.write() as tx:
        job, _ = start_import(tx)
    assert job.state is JobState.SUCCEEDED


def test_an_import_that_waits_has_no_owner_and_is_never_abandoned(store: Store) -> None:
    with store.write() as tx:
        job, _ = start_import(tx, "a")
        take(tx)
        far = job.created_at + timedelta(days=9)
        assert leases.claim(tx, [JobKind.IMPORT], "worker", now=far) is None
        die(tx)
        assert jobs.get(tx, job.id).state is JobState.PROCESSING


def test_an_import_that_is_tried_again_skips_recorded_files(store: Store) -> None:
    with store.write() as tx:
        job = jobs.enqueue(tx, NewJob(JobKind.IMPORT))
        imports.add_entries(tx, job.id, [NewEntry("a.bvh", ImportOutcome.FAILED, problem=PROBLEM)])
        assert imports.recorded_paths(tx, job.id) == {"a.bvh"}


def test_canceling_an_import_cancels_its_waiting_clips(store: Store) -> None:
    with store.write() as tx:
        job, (running, waiting) = start_import(tx, "a", "b")
        claimed = take(tx)
        assert outcomes.request_cancel(tx, job.id).state is JobState.CANCELED
        assert clips.get(tx, waiting.id).state is ClipState.FAILED
        assert clips.get(tx, running.id).state is ClipState.PROCESSING
        assert leases.heartbeat(tx, claimed.lease)
        outcomes.finish_canceled(tx, claimed)
        assert clips.get(tx, running.id).state is ClipState.FAILED
        assert jobs.get(tx, job.id).state is JobState.CANCELED


def test_kills_from_outside_are_no_failures_but_end_the_job_at_last(
    store: Store,
) -> None:
    with store.write() as tx:
        clip = add(tx, "walk", max_attempts=1)
        for number in range(1, outcomes.MAX_KILLS + 1):
            claimed = take_whenever(tx)
            outcomes.retry_after_kill(tx, claimed, PROBLEM)
            assert states(tx, clip, claimed) == (ClipState.QUEUED, JobState.QUEUED)
            assert jobs.get_row(tx, claimed.job.id)["kills"] == number
        outcomes.retry_after_kill(tx, take_whenever(tx), PROBLEM)
        assert states(tx, clip, claimed) == (ClipState.FAILED, JobState.FAILED)


def take_whenever(tx: Tx) -> ClaimedJob:
    """As `take`, but also for a job whose next attempt is not due yet."""
    tx.exec_driver_sql("UPDATE jobs SET not_before = NULL")
    return take(tx)


def test_the_job_of_a_dead_process_is_canceled_at_once(store: Store) -> None:
    dead = (
        f"{owners.new_owner('worker')}1"  # another start time: another process has the number now
    )
    with store.write() as tx:
        clip = add(tx, "walk")
        claimed = queue.take(tx, ALL, dead)
        assert claimed is not None
        assert outcomes.request_cancel(tx, claimed.job.id).state is JobState.CANCELED
        assert clips.get(tx, clip.id).state is ClipState.FAILED
