"""No clip fails because a process is killed from outside, or because a clock jumps."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from datetime import timedelta
from pathlib import Path

import psutil
import pytest

from app.config import Settings
from app.demo import DemoClip
from app.services.clips import catalogue as clips
from app.services.clips import jobs
from app.services.library import analysis_pool
from app.services.library.library import Library
from app.services.training import models
from app.store.clips.record import ClipRecord, ClipState
from app.store.database import ids
from app.store.jobs import leases, outcomes
from app.store.jobs.record import JobState
from app.worker.loop import Worker, run_worker
from tests.busy_processes import (
    ENDLESS,
    LONG,
    busy_children,
    children_of,
    repeated,
    server_of,
)
from tests.libraries import settings_for, upload
from tests.live import wait_until
from tests.worker.worker_process import worker_process

NET_S = 300.0


@pytest.fixture
def lib(tmp_path: Path) -> Iterator[Library]:
    opened = Library.open(settings_for(tmp_path, job_lease_s=2.0, job_heartbeat_s=0.2))
    yield opened
    opened.close()


@pytest.fixture(scope="session")
def long_clip(kicks: list[DemoClip]) -> DemoClip:
    """A clip whose analysis takes seconds, for tests that wait for its end."""
    return replace(kicks[0], path="long.bvh", content=repeated(kicks[0], LONG))


@pytest.fixture(scope="session")
def endless_clip(kicks: list[DemoClip]) -> DemoClip:
    """A clip whose analysis is always killed before its end, even on a fast machine."""
    return replace(kicks[0], path="endless.bvh", content=repeated(kicks[0], ENDLESS))


@contextmanager
def _worker(settings: Settings) -> Iterator[psutil.Process]:
    """A worker process, which must live to the end of the block."""
    with worker_process(settings) as process:
        yield psutil.Process(process.pid)
        assert process.poll() is None


@contextmanager
def _worker_thread(settings: Settings) -> Iterator[None]:
    stop = threading.Event()
    thread = threading.Thread(target=run_worker, args=(settings, stop))
    thread.start()
    try:
        yield
    finally:
        stop.set()
        thread.join()


def _all(lib: Library) -> list[ClipRecord]:
    return list(clips.list_clips(lib, limit=1000).items)


def _wait_until_ended(lib: Library) -> None:
    wait_until(lambda: all(clip.is_settled for clip in _all(lib)), NET_S)


def _states(lib: Library) -> set[ClipState]:
    return {clip.state for clip in _all(lib)}


def _kill_busy(parent: psutil.Process) -> None:
    (child, *_) = wait_until(lambda: busy_children(parent), NET_S)
    child.kill()
    wait_until(lambda: not child.is_running(), NET_S)


def _kill_until_ended(lib: Library, kind: signal.Signals) -> None:
    """Kill every busy child of this process until all clips have ended.

    The number of kills is not fixed, because a child of an earlier test may be among them.
    """

    def has_ended() -> bool:
        for child in busy_children(psutil.Process()):
            with suppress(psutil.NoSuchProcess):
                child.send_signal(kind)
        return all(clip.is_settled for clip in _all(lib))

    wait_until(has_ended, NET_S)


@pytest.mark.slow
def test_more_kills_of_its_child_than_attempts_fail_no_clip(
    lib: Library, long_clip: DemoClip
) -> None:
    created = upload(lib, long_clip)
    with _worker(lib.settings) as worker:
        for _ in range(lib.settings.job_max_attempts + 1):
            _kill_busy(worker)
        _wait_until_ended(lib)
    assert _states(lib) == {ClipState.READY}
    assert created.job is not None
    assert jobs.get_job(lib, created.job.id).state is JobState.SUCCEEDED


def test_after_many_kills_a_clip_is_tried_alone_and_then_fails(
    lib: Library, endless_clip: DemoClip, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(outcomes, "MAX_KILLS", 1)
    alone: list[bool] = []
    submit = analysis_pool.AnalysisPool.submit

    def watched(pool: object, order: object, *, is_alone: bool = False) -> object:
        alone.append(is_alone)
        return submit(pool, order, is_alone=is_alone)  # type: ignore[arg-type]

    monkeypatch.setattr(analysis_pool.AnalysisPool, "submit", watched)
    clip = upload(lib, endless_clip).clip
    with _worker_thread(lib.settings):
        _kill_until_ended(lib, signal.SIGKILL)
    assert alone == [False, True]
    failed = clips.get_clip(lib, clip.id)
    assert failed.error is not None
    assert failed.error["code"] == "analysis_crashed"
    assert "stopped from outside" in failed.error["detail"]


def test_a_child_that_dies_by_its_own_work_counts(
    lib: Library, endless_clip: DemoClip, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.services.clips.ingest.RETRY_DELAY_S", 0.0)
    clip = upload(lib, endless_clip).clip
    with _worker_thread(lib.settings):
        _kill_until_ended(lib, signal.SIGSEGV)
    failed = clips.get_clip(lib, clip.id)
    assert failed.error is not None
    assert (failed.error["code"], "signal 11" in failed.error["detail"]) == (
        "analysis_crashed",
        True,
    )


def test_killing_the_fork_server_of_a_worker_fails_no_clip(
    lib: Library, kicks: list[DemoClip]
) -> None:
    for clip in kicks:
        upload(lib, clip)
    with _worker(lib.settings) as worker:
        for _ in range(2):
            # The server starts within the first seconds of the worker.
            server = wait_until(lambda: server_of(worker), NET_S)
            children = children_of(worker)
            for process in (server, *children):
                process.kill()
            wait_until(lambda old=server: server_of(worker) not in (None, old), NET_S)
        _wait_until_ended(lib)
    assert _states(lib) == {ClipState.READY}


@pytest.mark.slow
def test_a_fit_whose_child_is_killed_is_done_again(lib: Library, kicks: list[DemoClip]) -> None:
    for clip in kicks[:4]:
        upload(lib, clip)
    with _worker(lib.settings):
        _wait_until_ended(lib)
    job = models.request_fit(lib)
    with _worker(lib.settings) as worker:
        _kill_busy(worker)
        wait_until(lambda: not jobs.get_job(lib, job.id).is_open, NET_S)
    assert jobs.get_job(lib, job.id).state is JobState.SUCCEEDED


@pytest.mark.parametrize("jump", [timedelta(hours=1), timedelta(hours=-1)], ids=str)
def test_a_clock_that_jumps_while_clips_are_analyzed_fails_none(
    lib: Library,
    kicks: list[DemoClip],
    long_clip: DemoClip,
    monkeypatch: pytest.MonkeyPatch,
    jump: timedelta,
) -> None:
    for clip in (long_clip, *kicks[:3]):
        upload(lib, clip)
    with _worker_thread(lib.settings):
        wait_until(lambda: busy_children(psutil.Process()), NET_S)
        _move_clock(monkeypatch, jump)
        _wait_until_ended(lib)
    assert _states(lib) == {ClipState.READY}


def _move_clock(monkeypatch: pytest.MonkeyPatch, jump: timedelta) -> None:
    """Moves the system time in this process, in all modules that ever measured durations by it."""
    real, now = time.time, ids.utc_now
    monkeypatch.setattr(time, "time", lambda: real() + jump.total_seconds())
    for module in (leases, outcomes):
        monkeypatch.setattr(module, "utc_now", lambda: now() + jump)


@pytest.mark.parametrize("is_canceled", [False, True])
def test_the_job_of_a_dead_worker_with_a_fast_clock_is_free_within_a_lease(
    lib: Library, kicks: list[DemoClip], monkeypatch: pytest.MonkeyPatch, is_canceled: bool
) -> None:
    created = upload(lib, kicks[0])
    assert created.job is not None
    job_id = created.job.id
    with monkeypatch.context() as ahead:
        _move_clock(ahead, timedelta(hours=1))
        # With such a name nobody can see that its process is dead, as on another machine.
        ahead.setattr("app.store.jobs.owners.new_owner", lambda prefix: f"{prefix}@elsewhere")
        dead = Worker(lib)
        dead.turn()
        dead.executors.close()  # for the store this worker is dead
    if is_canceled:
        jobs.cancel_or_remove(lib, job_id)
    with _worker(lib.settings):
        wait_until(lambda: not jobs.get_job(lib, job_id).is_open, NET_S)
    expected = JobState.CANCELED if is_canceled else JobState.SUCCEEDED
    assert jobs.get_job(lib, job_id).state is expected
