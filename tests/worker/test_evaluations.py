"""Evaluations run in a process of their own: how far they are is seen, and they can be stopped."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import psutil
import pytest

from app.demo import DemoClip
from app.services.children.progress_file import progress_to
from app.services.clips import jobs
from app.services.evaluations import evaluations
from app.services.evaluations.options import EvaluationKind, EvaluationOptions
from app.services.library.library import Library
from app.store.jobs.record import JobKind, JobRecord, JobState
from app.worker import executors
from app.worker.loop import Worker
from tests.libraries import settings_for, upload, work
from tests.live import wait_until

TIMEOUT_S = 240.0


def _endless(_settings: Any, _kind: Any, _options: Any, progress_path: str) -> None:
    """An evaluation that does three of ten steps, and then nothing until it is killed."""
    progress_to(progress_path)(3, 10)
    threading.Event().wait()


@pytest.fixture
def lib(tmp_path: Path) -> Iterator[Library]:
    opened = Library.open(settings_for(tmp_path, analysis_processes=2, job_heartbeat_s=0.1))
    yield opened
    opened.close()


def _request(lib: Library) -> JobRecord:
    return evaluations.request(lib, EvaluationKind.SYMBOLS, EvaluationOptions())


def _until(lib: Library, job: JobRecord, is_so: Callable[[JobRecord], bool]) -> None:
    wait_until(lambda: is_so(jobs.get_job(lib, job.id)), TIMEOUT_S)


def _working(lib: Library) -> tuple[threading.Thread, threading.Event]:
    """A worker in a thread, and the event that stops it."""
    stop = threading.Event()
    worker = Worker(lib)

    def run() -> None:
        try:
            worker.run(stop)
        finally:
            worker.close()

    thread = threading.Thread(target=run)
    thread.start()
    return thread, stop


def test_a_running_evaluation_shows_its_progress_and_is_canceled(
    lib: Library, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(executors, "evaluate_in_child", _endless)
    job = _request(lib)
    thread, stop = _working(lib)
    try:
        _until(lib, job, lambda now: now.progress == 0.3)
        assert jobs.get_job(lib, job.id).detail == "judging symbols: 3 of 10 steps"
        before = set(psutil.Process().children(recursive=True))
        jobs.cancel_or_remove(lib, job.id)
        _until(lib, job, lambda now: now.state is JobState.CANCELED)
        wait_until(lambda: any(not child.is_running() for child in before), TIMEOUT_S)
    finally:
        stop.set()
        thread.join()
    assert evaluations.list_evaluations(lib).items == ()


def test_a_stopped_worker_puts_its_evaluation_back(
    lib: Library, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(executors, "evaluate_in_child", _endless)
    job = _request(lib)
    thread, stop = _working(lib)
    _until(lib, job, lambda now: now.progress == 0.3)
    stop.set()
    thread.join()
    assert jobs.get_job(lib, job.id).state is JobState.QUEUED


def test_clips_are_analyzed_and_models_fitted_while_an_evaluation_runs(
    lib: Library, kicks: list[DemoClip], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(executors, "evaluate_in_child", _endless)
    job = _request(lib)
    thread, stop = _working(lib)
    try:
        _until(lib, job, lambda now: now.progress == 0.3)
        for clip in kicks[:2]:
            upload(lib, clip)
        # Two ready clips are enough for a fit, which nobody has to ask for.
        wait_until(lambda: any(_ended_fits(lib)), TIMEOUT_S)
        assert jobs.get_job(lib, job.id).state is JobState.PROCESSING
    finally:
        stop.set()
        thread.join()


def _ended_fits(lib: Library) -> Iterator[bool]:
    return (job.state is JobState.SUCCEEDED for job in jobs.list_jobs(lib, kind=JobKind.FIT).items)


def test_a_library_without_clips_fails_with_the_reason(lib: Library) -> None:
    job = _request(lib)
    work(lib.settings)
    ended = jobs.get_job(lib, job.id)
    assert ended.state is JobState.FAILED
    assert ended.error is not None
    assert ended.error["code"] == "not_enough_labels"
