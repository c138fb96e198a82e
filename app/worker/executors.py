"""Starts each claimed job in a process or thread, by the job's kind."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, TypeVar

from app.kinedex_error import KinedexError
from app.logs import level_of_process
from app.models.keyposes.thresholds import Thresholds
from app.services.children.pool import ChildPool
from app.services.children.processes import log_like_parent
from app.services.children.progress_file import ProgressFile
from app.services.clips import ingest
from app.services.evaluations import evaluations
from app.services.imports import imports
from app.services.library.analysis_pool import AnalysisPool
from app.services.library.library import Library, ingest_limits
from app.services.training.fit_process import fit_in_child
from app.store.clips.record import ClipRecord
from app.store.jobs import outcomes
from app.store.jobs.record import ClaimedJob, JobKind
from app.worker.evaluation_process import evaluate_in_child
from app.worker.running import (
    RunningEvaluation,
    RunningFit,
    RunningImport,
    RunningIngest,
    RunningJob,
)

Result = TypeVar("Result")


class JobExecutors:
    """The processes and threads that do the jobs of one worker."""

    def __init__(self, lib: Library) -> None:
        self.lib = lib
        self.slots = lib.settings.analysis_processes or os.cpu_count() or 1
        self._analyses = AnalysisPool(
            ingest_limits(lib.settings), size=self.slots, cache=lib.settings.cache_dir
        )
        self._threads = ThreadPoolExecutor(1, thread_name_prefix="import")

    def begin(
        self, claimed: ClaimedJob, clip: ClipRecord | None, thresholds: Thresholds | None = None
    ) -> RunningJob:
        """Begin a job. clip: of an ingest job, as it is stored now; None for other jobs.

        thresholds: of the keyposes of the clip, by default those of the library.
        """
        if clip is not None:
            return self._begin_ingest(claimed, clip, thresholds)
        if claimed.job.kind is JobKind.IMPORT:
            return self._begin_import(claimed)
        if claimed.job.kind is JobKind.EVALUATE:
            return self._begin_evaluation(claimed)
        return RunningFit(claimed, _in_process(fit_in_child, self.lib.settings))

    def rest(self) -> None:
        """End idle analysis processes, so that their memory is free."""
        self._analyses.rest()

    def close(self) -> None:
        """End all processes and threads."""
        self._analyses.close()
        self._threads.shutdown()

    def _begin_ingest(
        self, claimed: ClaimedJob, clip: ClipRecord, thresholds: Thresholds | None
    ) -> RunningJob:
        try:
            request = ingest.analysis_request(self.lib, clip, thresholds)
            # The kernel kills a process when memory is short, and that process may not be the one
            # that needs it. A job that was killed often is therefore tried without others.
            is_alone = claimed.kills >= outcomes.MAX_KILLS
            future = self._analyses.submit(request, is_alone=is_alone)
        except KinedexError as problem:
            future = Future()
            future.set_exception(problem)
        return RunningIngest(self.lib, self._analyses, claimed, clip, future)

    def _begin_import(self, claimed: ClaimedJob) -> RunningJob:
        stopping = threading.Event()
        latest: list[tuple[float, str]] = [(0.0, "")]

        def progress(done: int, total: int, path: str) -> None:
            latest[0] = (done / max(total, 1), f"{done} of {total} files: {path}")

        future = self._threads.submit(imports.unpack, self.lib, claimed, progress, stopping.is_set)
        return RunningImport(claimed, future, stopping, latest)

    def _begin_evaluation(self, claimed: ClaimedJob) -> RunningJob:
        kind, options = evaluations.requested(claimed)
        progress = ProgressFile()
        future = _in_process(evaluate_in_child, self.lib.settings, kind, options, progress.path)
        return RunningEvaluation(claimed, future, kind, progress)


def _in_process(work: Callable[..., Result], *arguments: Any) -> Future[Result]:
    """Begin work in a process of its own, so that its memory is free when it ends."""
    pool = ChildPool(1, log_like_parent, level_of_process())
    future = pool.submit(work, *arguments)
    # The callback runs in a thread that `close` waits for, so `close` needs another thread.
    future.add_done_callback(lambda _: threading.Thread(target=pool.close).start())
    return future
