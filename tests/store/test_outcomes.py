"""How work ends: job, clip and import together, and each clip once."""

from __future__ import annotations

from datetime import timedelta

import numpy as np
import pytest

from app.errors import LeaseLost
from app.store import arrays, clips, imports, jobs, leases, library, outcomes, owners, queue
from app.store.abandoned import Watch
from app.store.clip_record import ClipRecord, ClipState, Reanalysis
from app.store.engine import Tx
from app.store.imports import ImportOutcome
from app.store.job_record import ClaimedJob, JobKind, JobRecord, JobState, NewJob
from app.store.store import Store
from tests.store.conftest import facts, new_clip

ALL = tuple(JobKind)
PROBLEM = {"code": "unreadable", "detail": "line 3"}
FOUND = {"motion_vector": np.ones(128, np.float32)}


def add(tx: Tx, name: str, **job: int) -> ClipRecord:
    """A clip with its ingest job, as an upload makes them."""
    clip = clips.add_or_get(tx, new_clip(name)).clip
    jobs.enqueue(tx, NewJob(JobKind.INGEST, clip_id=clip.id, **job))
    return clip


def take(tx: Tx) -> ClaimedJob:
    claimed = queue.take(tx, ALL, "worker")
    assert claimed is not None
    return claimed


def die(tx: Tx) -> None:
    """The holders of all jobs are dead, and another worker sees it."""
    watch = Watch("watcher", 0.0)
    queue.recover(tx, watch, watch.look(tx))


def states(tx: Tx, clip: ClipRecord, claimed: ClaimedJob) -> tuple[ClipState, JobState]:
    return clips.get(tx, clip.id).state, jobs.get(tx, claimed.job.id).state


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
        assert arrays.get_all(tx, clip.id) == {}
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


def test_what_may_pass_is_tried_again_and_then_given_up(store: Store) -> None:
    with store.write() as tx:
        clip = add(tx, "walk", max_attempts=2)
        claimed = take(tx)
        outcomes.retry_or_fail(tx, claimed, PROBLEM, delay_s=-1)
        assert states(tx, clip, claimed) == (ClipState.QUEUED, JobState.QUEUED)
        outcomes.retry_or_fail(tx, take(tx), PROBLEM, delay_s=-1)
        assert states(tx, clip, claimed) == (ClipState.FAILED, JobState.FAILED)


def test_a_worker_told_to_stop_gives_its_clip_back(store: Store) -> None:
    with store.write() as tx:
        clip = add(tx, "walk", max_attempts=1)
        for _ in range(3):
            outcomes.give_back(tx, claimed := take(tx))
            assert states(tx, clip, claimed) == (ClipState.QUEUED, JobState.QUEUED)


def test_cancel_a_queued_job(store: Store) -> None:
    with store.write() as tx:
        clip = add(tx, "walk")
        job = jobs.open_for_clip(tx, clip.id)
        assert job is not None
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
        imports.add_entry(tx, job.id, f"{name}.bvh", ImportOutcome.QUEUED, clip_id=clip.id)
        added.append(clip)
    imports.add_entry(tx, job.id, "z.txt", ImportOutcome.FAILED, problem=PROBLEM)
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
        "ready": 1,
        "exists": 0,
        "failed": 2,
        "deleted": 1,
        "files": [
            {"path": "a.bvh", "outcome": "ready", "clip_id": good.id, "error": None},
            {"path": "b.bvh", "outcome": "failed", "clip_id": bad.id, "error": PROBLEM},
            {"path": "c.bvh", "outcome": "deleted", "clip_id": None, "error": None},
            {"path": "z.txt", "outcome": "failed", "clip_id": None, "error": PROBLEM},
        ],
    }


def test_an_import_with_nothing_to_wait_for_ends_at_once(store: Store) -> None:
    with store.write() as tx:
        job, _ = start_import(tx)
    assert job.state is JobState.SUCCEEDED


def test_an_import_that_waits_is_nobodys_and_never_expires(store: Store) -> None:
    with store.write() as tx:
        job, _ = start_import(tx, "a")
        take(tx)
        far = job.created_at + timedelta(days=9)
        assert leases.claim(tx, [JobKind.IMPORT], "worker", now=far) is None
        die(tx)
        assert jobs.get(tx, job.id).state is JobState.PROCESSING


def test_an_import_that_is_tried_again_knows_what_it_has_done(store: Store) -> None:
    with store.write() as tx:
        job = jobs.enqueue(tx, NewJob(JobKind.IMPORT))
        imports.add_entry(tx, job.id, "a.bvh", ImportOutcome.FAILED, problem=PROBLEM)
        assert imports.recorded_paths(tx, job.id) == {"a.bvh"}


def test_cancelling_an_import_cancels_what_waits(store: Store) -> None:
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


def make_ready(tx: Tx, name: str) -> ClipRecord:
    clip = add(tx, name)
    outcomes.finish_ingest(tx, take(tx).lease, clip.id, facts(), FOUND)
    return clip


def analyse_again(tx: Tx, clip: ClipRecord) -> ClaimedJob:
    """The clip waits for another analysis, and a worker takes it."""
    jobs.enqueue(tx, NewJob(JobKind.INGEST, clip_id=clip.id, max_attempts=2))
    waiting = clips.requeue(tx, clip.id)
    assert (waiting.state, waiting.reanalysis) == (ClipState.READY, Reanalysis.QUEUED)
    return take(tx)


def test_a_ready_clip_stays_ready_until_another_analysis_replaces_the_first(store: Store) -> None:
    with store.write() as tx:
        clip = make_ready(tx, "walk")
        before = library.version(tx)
        claimed = analyse_again(tx, clip)
        worked_on = clips.get(tx, clip.id)
        assert (worked_on.state, worked_on.reanalysis) == (ClipState.READY, Reanalysis.PROCESSING)
        assert library.version(tx) == before  # nothing that a search could see has changed
        outcomes.give_back(tx, claimed)
        assert clips.get(tx, clip.id).reanalysis is Reanalysis.QUEUED
        anew = {"motion_vector": np.zeros(128, np.float32)}
        outcomes.finish_ingest(tx, take(tx).lease, clip.id, facts(frames=7), anew)
        done = clips.get(tx, clip.id)
        assert (done.state, done.reanalysis, done.frames) == (ClipState.READY, None, 7)
        assert not arrays.get_one(tx, clip.id, "motion_vector").any()


MISSING = {"code": "file_missing", "detail": "The stored motion file is missing"}


@pytest.mark.parametrize(
    ("problem", "is_verdict", "is_changed", "state", "code"),
    [
        (PROBLEM, True, False, ClipState.READY, "reanalysis_failed"),
        (PROBLEM, True, True, ClipState.FAILED, None),
        (PROBLEM, False, True, ClipState.READY, "reanalysis_failed"),
        (MISSING, False, True, ClipState.READY, "file_missing"),
    ],
)
def test_only_a_verdict_after_a_change_takes_a_ready_clip_away(
    store: Store,
    problem: dict[str, str],
    is_verdict: bool,
    is_changed: bool,
    state: ClipState,
    code: str | None,
) -> None:
    with store.write() as tx:
        clip = make_ready(tx, "walk")
        if is_changed:
            clips.patch(tx, clip.id, {"frame_rate_override": 12.0})
        claimed = analyse_again(tx, clip)
        outcomes.fail_job(tx, claimed, problem, is_verdict=is_verdict)
        found = clips.get(tx, clip.id)
        assert (found.state, jobs.get(tx, claimed.job.id).state) == (state, JobState.FAILED)
        told = {warning.code: warning.detail for warning in found.warnings}
        assert (code is None) == (found.reanalysis is None)
        if code is not None:
            assert found.reanalysis is Reanalysis.FAILED
            assert problem["detail"] in told[code]
            assert arrays.get_one(tx, clip.id, "motion_vector").all()
        # One that works takes the warning away.
        outcomes.finish_ingest(tx, analyse_again_whatever(tx, clip).lease, clip.id, facts(), FOUND)
        healed = clips.get(tx, clip.id)
        assert (healed.state, healed.reanalysis) == (ClipState.READY, None)
        assert code not in {warning.code for warning in healed.warnings}


def analyse_again_whatever(tx: Tx, clip: ClipRecord) -> ClaimedJob:
    jobs.enqueue(tx, NewJob(JobKind.INGEST, clip_id=clip.id))
    clips.requeue(tx, clip.id)
    return take(tx)


def test_a_ready_clip_survives_dead_workers_and_a_cancellation(store: Store) -> None:
    with store.write() as tx:
        clip = make_ready(tx, "walk")
        analyse_again(tx, clip)
        die(tx)
        assert clips.get(tx, clip.id).reanalysis is Reanalysis.QUEUED
        claimed = take(tx)
        die(tx)
        assert jobs.get(tx, claimed.job.id).state is JobState.FAILED
        found = clips.get(tx, clip.id)
        assert (found.state, found.reanalysis) == (ClipState.READY, Reanalysis.FAILED)
        again = analyse_again(tx, clip)
        outcomes.finish_canceled(tx, again)
        assert clips.get(tx, clip.id).state is ClipState.READY


def test_a_child_killed_from_outside_does_not_count_and_is_given_up_in_the_end(
    store: Store,
) -> None:
    with store.write() as tx:
        clip = add(tx, "walk", max_attempts=1)
        for number in range(1, outcomes.MOST_KILLS + 1):
            claimed = take_whenever(tx)
            outcomes.retry_after_kill(tx, claimed, PROBLEM)
            assert states(tx, clip, claimed) == (ClipState.QUEUED, JobState.QUEUED)
            assert jobs.get_row(tx, claimed.job.id)["kills"] == number
        outcomes.retry_after_kill(tx, take_whenever(tx), PROBLEM)
        assert states(tx, clip, claimed) == (ClipState.FAILED, JobState.FAILED)


def take_whenever(tx: Tx) -> ClaimedJob:
    """As `take`, though a retry is to wait."""
    tx.exec_driver_sql("UPDATE jobs SET not_before = NULL")
    return take(tx)


def test_the_job_of_a_process_that_is_gone_is_canceled_at_once(store: Store) -> None:
    dead = f"{owners.new_owner('worker')}1"  # another process has its number now
    with store.write() as tx:
        clip = add(tx, "walk")
        claimed = queue.take(tx, ALL, dead)
        assert claimed is not None
        assert outcomes.request_cancel(tx, claimed.job.id).state is JobState.CANCELED
        assert clips.get(tx, clip.id).state is ClipState.FAILED
