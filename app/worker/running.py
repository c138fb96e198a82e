"""Running jobs, one class for each kind.

The worker's loop begins and settles them in its own thread. A child process or another thread does
the work and sets a future, so that the loop can send heartbeats meanwhile.
"""

from __future__ import annotations

import logging
import threading
from concurrent.futures import Future
from dataclasses import dataclass, field
from typing import Any, Protocol

from app.analysis.analyze import Analysis
from app.errors import AnalysisInterrupted, Canceled, ClipNotFound, StorageError
from app.kinedex_error import KinedexError
from app.services.children.child import ChildDied, ChildEnded
from app.services.children.progress_file import ProgressFile
from app.services.clips import ingest
from app.services.evaluations import evaluations
from app.services.evaluations.evaluations import Evaluated
from app.services.evaluations.options import EvaluationKind
from app.services.library.analysis_pool import AnalysisPool
from app.services.library.library import Library
from app.store.clips.record import ClipRecord
from app.store.database.engine import Tx
from app.store.jobs import leases, outcomes
from app.store.jobs.record import ClaimedJob

_log = logging.getLogger(__name__)

RETRY_DELAY_S = 5.0
"""Time before an import, a fit or an evaluation is tried again after the store failed."""

MAX_PROGRESS = 0.99
"""The largest completed share of an evaluation that still runs."""


class RunningJob(Protocol):
    """A claimed job whose work has begun."""

    claimed: ClaimedJob
    future: Future[Any]

    def stop(self) -> None:
        """Make the work end soon, without a result."""
        ...

    def settle(self, tx: Tx) -> None:
        """Store the result or the failure of the finished work. Raises LeaseLost, StorageError."""
        ...

    def progress(self) -> tuple[float | None, str | None]:
        """The completed share, 0..1, and a text; None where the job cannot know it."""
        ...


@dataclass(slots=True)
class RunningIngest:
    """The analysis of one clip, in a child process."""

    lib: Library
    pool: AnalysisPool
    claimed: ClaimedJob
    clip: ClipRecord
    future: Future[Analysis]

    def stop(self) -> None:
        """Kills the child."""
        self.future.cancel()

    def settle(self, tx: Tx) -> None:
        """Make the clip ready or failed; a clip that was deleted meanwhile stays deleted."""
        try:
            try:
                analysis = self.pool.outcome(self.future)
            except KinedexError as problem:
                max_attempts = self.lib.settings.job_max_attempts
                ingest.fail(tx, self.claimed, self.clip, problem, max_attempts)
            else:
                ingest.finish(tx, self.claimed, self.clip, analysis)
        except ClipNotFound:
            _log.info("clip %s was deleted while it was analyzed", self.clip.id)

    def progress(self) -> tuple[float | None, str | None]:
        """Nothing, because an analysis is short."""
        return None, None


@dataclass(slots=True)
class RunningImport:
    """An import, in a thread of this process. The thread itself settles it if it succeeds.

    latest_progress: one item, which the thread replaces: the completed share, and a text.
    """

    claimed: ClaimedJob
    future: Future[None]
    stopping: threading.Event
    latest_progress: list[tuple[float, str]] = field(default_factory=lambda: [(0.0, "")])

    def stop(self) -> None:
        """Sets the event that the thread checks before each file."""
        self.stopping.set()

    def settle(self, tx: Tx) -> None:
        """Stores the reason if the import failed."""
        _settle_failure(tx, self.claimed, self.future)

    def progress(self) -> tuple[float | None, str | None]:
        """The progress that the thread reported last."""
        return self.latest_progress[0]


@dataclass(slots=True)
class RunningFit:
    """A fit of all models, in a child process; its result becomes the result of the job."""

    claimed: ClaimedJob
    future: Future[dict[str, Any]]

    def stop(self) -> None:
        """Kills the child. Models that it has saved are complete and stay."""
        self.future.cancel()

    def settle(self, tx: Tx) -> None:
        """Stores the result or the failure."""
        if not _settle_failure(tx, self.claimed, self.future):
            leases.succeed(tx, self.claimed.lease, self.future.result())

    def progress(self) -> tuple[float | None, str | None]:
        """A text only: a fit does not report how far it is."""
        return None, "fitting the models"


@dataclass(slots=True)
class RunningEvaluation:
    """An evaluation, in a child process that writes its progress into a file."""

    claimed: ClaimedJob
    future: Future[Evaluated]
    kind: EvaluationKind
    file: ProgressFile

    def stop(self) -> None:
        """Kills the child."""
        self.future.cancel()
        self.file.close()

    def settle(self, tx: Tx) -> None:
        """Keeps the result, or stores the failure."""
        self.file.close()
        if not _settle_failure(tx, self.claimed, self.future):
            evaluations.finish(tx, self.claimed, self.future.result())

    def progress(self) -> tuple[float | None, str | None]:
        """The share of the steps done; a text only for kinds that do not count steps."""
        done, total = self.file.read()
        if not total:
            return None, f"judging {self.kind.value}"
        # After the last step the result is still put together: only the end of the job is 100 %.
        share = min(done / total, MAX_PROGRESS)
        return share, f"judging {self.kind.value}: {done:,} of {total:,} steps"


def _settle_failure(tx: Tx, claimed: ClaimedJob, future: Future[Any]) -> bool:
    """Store the failure of the work, if it failed; returns whether it failed."""
    failure = future.exception()
    if failure is None:
        return False
    if isinstance(failure, Canceled):
        return True  # the code that stopped the work settles the job
    problem = _as_problem(claimed, failure)
    if isinstance(problem, AnalysisInterrupted):
        outcomes.retry_after_kill(tx, claimed, problem.as_problem())
    elif isinstance(problem, StorageError | ChildDied):
        outcomes.retry_or_fail(tx, claimed, problem.as_problem(), delay_s=RETRY_DELAY_S)
    else:
        outcomes.fail_job(tx, claimed, problem.as_problem())
    return True


def _as_problem(claimed: ClaimedJob, failure: BaseException) -> KinedexError:
    if isinstance(failure, KinedexError):
        return failure
    if isinstance(failure, ChildEnded):
        return failure.as_failure()
    _log.error("job %s failed unexpectedly", claimed.job.id, exc_info=failure)
    return KinedexError(_unexpected_message(failure))


def _unexpected_message(failure: BaseException) -> str:
    # The message of the exception may quote a file or an API key, so only the log has it.
    return f"The work failed unexpectedly ({type(failure).__name__}); see the log."
