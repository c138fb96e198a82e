"""Every clip ends exactly once, even if workers are killed, stopped, too slow or canceled."""

from __future__ import annotations

import io
import signal
import threading
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import wait
from pathlib import Path

import psutil
import pytest

from app.demo import DemoClip, demo_clips
from app.errors import LeaseLost
from app.services.clips import catalogue as clips
from app.services.clips import jobs
from app.services.imports import imports
from app.services.library.library import Library
from app.services.training import models, refit
from app.store.clips.record import ClipRecord, ClipState
from app.store.jobs.record import JobKind, JobRecord, JobState
from app.worker.loop import Worker, run_worker
from tests.libraries import settings_for, upload, work
from tests.live import wait_until
from tests.worker.worker_process import worker_process
from tests.zip_archives import zip_archive

TIMEOUT_S = 240.0
SHORT_LEASES = {"job_lease_s": 1.0, "job_heartbeat_s": 0.2}


@pytest.fixture
def lib(tmp_path: Path) -> Iterator[Library]:
    opened = Library.open(settings_for(tmp_path, **SHORT_LEASES, analysis_processes=2))
    yield opened
    opened.close()


def _archive(demo: list[DemoClip]) -> io.BytesIO:
    """The clips, a file that cannot be read, and a file that is no motion."""
    clip_files = {clip.path: clip.content for clip in demo}
    return zip_archive(clip_files | {"bad.bvh": b"HIERARCHY\nROOT\n", "notes.txt": b"not a motion"})


def _all_clips(lib: Library) -> list[ClipRecord]:
    return list(clips.list_clips(lib, limit=1000).items)


def _ended(lib: Library) -> int:
    return sum(c.state in (ClipState.READY, ClipState.FAILED) for c in _all_clips(lib))


def _kill_in_the_middle(lib: Library) -> None:
    """Start a worker, wait until it has ended at least one more clip, and kill it by SIGKILL."""
    before = _ended(lib)
    with worker_process(lib.settings) as process:
        wait_until(lambda: _ended(lib) > before or not _is_open(lib), TIMEOUT_S)
        children = psutil.Process(process.pid).children(recursive=True)
        process.send_signal(signal.SIGKILL)
        process.wait()
    _, alive = psutil.wait_procs(children, timeout=300)
    assert not alive


def _is_open(lib: Library) -> bool:
    return any(job.is_open for job in jobs.list_jobs(lib, limit=1000).items)


def _check_that_all_ended_once(lib: Library, demo: list[DemoClip], job: JobRecord) -> None:
    found = _all_clips(lib)
    assert len({clip.sha256 for clip in found}) == len(found) == len(demo) + 1
    assert Counter(clip.state for clip in found) == {
        ClipState.READY: len(demo),
        ClipState.FAILED: 1,
    }
    (failed,) = (clip for clip in found if clip.state is ClipState.FAILED)
    assert failed.error is not None
    assert failed.error["code"] == "unreadable"
    done = jobs.get_job(lib, job.id)
    assert done.state is JobState.SUCCEEDED
    assert done.result is not None
    outcomes = Counter(line["outcome"] for line in done.result["files"])
    assert outcomes == {"ready": len(demo), "failed": 1, "skipped": 1}
    ingests = jobs.list_jobs(lib, kind=JobKind.INGEST, limit=1000).items
    assert Counter(j.state for j in ingests) == {JobState.SUCCEEDED: len(demo), JobState.FAILED: 1}


def _work_to_the_end(lib: Library) -> None:
    run_worker(lib.settings, threading.Event(), until=lambda _: not _is_open(lib))


def test_every_clip_of_an_import_ends_once_if_its_worker_is_killed(
    lib: Library, kicks: list[DemoClip]
) -> None:
    job = imports.start_import(lib, _archive(kicks), "kicks.zip")
    for _ in range(2):
        _kill_in_the_middle(lib)
    _work_to_the_end(lib)
    _check_that_all_ended_once(lib, kicks, job)


@pytest.mark.slow
def test_every_clip_ends_once_if_its_worker_is_killed_ten_times(lib: Library) -> None:
    demo = list(demo_clips(tasks=("kick", "bow", "punch"), takes=3))
    job = imports.start_import(lib, _archive(demo), "many.zip")
    for _ in range(10):
        _kill_in_the_middle(lib)
    _work_to_the_end(lib)
    _check_that_all_ended_once(lib, demo, job)


def test_a_stopped_worker_puts_its_jobs_back(lib: Library, kicks: list[DemoClip]) -> None:
    for clip in kicks[:4]:
        upload(lib, clip)
    worker = Worker(lib)
    assert worker.turn()
    held = [running.claimed for running in worker.running]
    worker.close()
    assert held
    states = {jobs.get_job(lib, claimed.job.id).state for claimed in held}
    assert states == {JobState.QUEUED}
    assert {clip.state for clip in _all_clips(lib)} == {ClipState.QUEUED}
    work(lib.settings)
    assert {clip.state for clip in _all_clips(lib)} == {ClipState.READY}


def test_sigterm_ends_a_worker_process_cleanly(lib: Library, kicks: list[DemoClip]) -> None:
    for clip in kicks:
        upload(lib, clip)
    with worker_process(lib.settings) as process:
        wait_until(lambda: _ended(lib) > 0, TIMEOUT_S)
        process.terminate()
        assert process.wait(300) == 0
    open_states = {j.state for j in jobs.list_jobs(lib, limit=100).items if j.is_open}
    assert open_states <= {JobState.QUEUED}


def test_a_clip_deleted_while_it_is_analyzed_stays_deleted(
    lib: Library, kicks: list[DemoClip]
) -> None:
    clip = upload(lib, kicks[0]).clip
    worker = Worker(lib)
    worker.turn()
    clips.delete_clip(lib, clip.id)
    _until_settled(worker)
    worker.close()
    assert _all_clips(lib) == []


def test_a_frame_rate_changed_during_the_analysis_wins(lib: Library, kicks: list[DemoClip]) -> None:
    clip = upload(lib, kicks[0]).clip
    worker = Worker(lib)
    worker.turn()
    clips.update_clip(lib, clip.id, {"frame_rate": 21.0})
    _until_settled(worker)
    worker.close()
    assert clips.get_clip(lib, clip.id).state is ClipState.QUEUED
    work(lib.settings)
    assert clips.get_clip(lib, clip.id).frame_rate == 21.0


def test_a_canceled_analysis_fails_its_clip_with_the_reason(
    lib: Library, kicks: list[DemoClip]
) -> None:
    created = upload(lib, kicks[0])
    assert created.job is not None
    jobs.cancel_or_remove(lib, created.job.id)
    work(lib.settings)
    clip = clips.get_clip(lib, created.clip.id)
    assert clip.state is ClipState.FAILED
    assert clip.error is not None
    assert clip.error["code"] == "canceled"
    assert upload(lib, kicks[0]).is_new


def test_a_worker_that_lost_its_lease_changes_nothing(lib: Library, kicks: list[DemoClip]) -> None:
    upload(lib, kicks[0])
    slow = Worker(lib)
    slow.turn()
    (running,) = slow.running
    running.future.result()
    _work_to_the_end(lib)  # another worker, for which this one seems dead
    with pytest.raises(LeaseLost), lib.store.write() as tx:
        running.settle(tx)
    slow.turn()
    assert slow.running == ()
    slow.close()
    assert [clip.state for clip in _all_clips(lib)] == [ClipState.READY]


def test_a_fit_is_due_only_after_the_library_has_changed_enough(
    lib: Library, kicks: list[DemoClip]
) -> None:
    for clip in kicks[:10]:
        upload(lib, clip)
    work(lib.settings)
    with lib.store.read() as tx:
        assert refit.is_fit_due(tx, 0.1)
    models.request_fit(lib)
    with lib.store.read() as tx:
        assert not refit.is_fit_due(tx, 0.1)
    work(lib.settings)
    with lib.store.read() as tx:
        assert not refit.is_fit_due(tx, 0.1)
    some = _all_clips(lib)
    clips.update_clip(lib, some[0].id, {"task": "another"})
    with lib.store.read() as tx:
        assert refit.is_fit_due(tx, 0.1)
        assert not refit.is_fit_due(tx, 0.2)
    clips.delete_clip(lib, some[1].id)
    with lib.store.read() as tx:
        assert refit.is_fit_due(tx, 0.2)  # a deleted clip counts as a change too


def _until_settled(worker: Worker) -> None:
    wait([running.future for running in worker.running])
    assert worker.turn()
