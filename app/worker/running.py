"""Work in hand: one claimed job each, begun, watched and settled by the worker's loop.

Beginning and settling happen in the loop's thread; the work itself in a child process or a
thread, behind a future, so that the loop is free for heartbeats.
"""

from __future__ import annotations

import logging
import threading
from concurrent.futures import Future
from dataclasses import dataclass, field
from typing import Any, Protocol

from app.analysis.analyze import Analysis
from app.errors import AnalysisInterrupted, Canceled, ClipNotFound, KinedexError, StorageError
from app.services.children.child import ChildDied, ChildEnded
from app.services.clips import ingest
from app.services.library.analysis_pool import AnalysisPool
from app.services.library.library import Library
from app.store.clips.record import ClipRecord
from app.store.database.engine import Tx
from app.store.jobs import leases, outcomes
from app.store.jobs.record import ClaimedJob

_log = logging.getLogger(__name__)

RETRY_DELAY_S = 5.0
"""Before an import or a fit that the store failed is tried again."""


class RunningJob(Protocol):
    """A job in hand."""

    claimed: ClaimedJob
    future: Future[Any]

    def stop(self) -> None:
        """Have the work end soon, without a result."""
        ...

    def settle(self, tx: Tx) -> None:
        """Record what the finished work came to. Raises LeaseLost, StorageError."""
        ...

    def progress(self) -> tuple[float | None, str | None]:
        """How far it is, 0..1, and in words; None where that is not known."""
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
        """Ready, or failed for its own reason; nothing where the clip was deleted meanwhile."""
        try:
            try:
                found = self.pool.outcome(self.future)
            except KinedexError as problem:
                most = self.lib.settings.job_max_attempts
                ingest.fail(tx, self.claimed, self.clip, problem, most)
            else:
                ingest.finish(tx, self.claimed, self.clip, found)
        except ClipNotFound:
            _log.info("clip %s was deleted while it was analysed", self.clip.id)

    def progress(self) -> tuple[float | None, str | None]:
        """Not known."""
        return None, None


@dataclass(slots=True)
class RunningImport:
    """An import, in a thread of this process; it settles itself when all goes well."""

    claimed: ClaimedJob
    future: Future[None]
    stopping: threading.Event
    told: list[tuple[float, str]] = field(default_factory=lambda: [(0.0, "")])

    def stop(self) -> None:
        """Asks the thread, which looks before each file."""
        self.stopping.set()

    def settle(self, tx: Tx) -> None:
        """Records why it could not be done."""
        _settle_failure(tx, self.claimed, self.future)

    def progress(self) -> tuple[float | None, str | None]:
        """As the thread last told."""
        return self.told[0]


@dataclass(slots=True)
class RunningFit:
    """A fit of all models, in a child process; its result is the job's."""

    claimed: ClaimedJob
    future: Future[dict[str, Any]]

    def stop(self) -> None:
        """Kills the child; models that it has saved are whole and stay."""
        self.future.cancel()

    def settle(self, tx: Tx) -> None:
        """Records the result, or why there is none."""
        if not _settle_failure(tx, self.claimed, self.future):
            leases.succeed(tx, self.claimed.lease, self.future.result())

    def progress(self) -> tuple[float | None, str | None]:
        """Not known."""
        return None, "fitting the models"


def _settle_failure(tx: Tx, claimed: ClaimedJob, future: Future[Any]) -> bool:
    """Record a failure of the work, if it failed; whether it did."""
    failure = future.exception()
    if failure is None:
        return False
    if isinstance(failure, Canceled):
        return True  # whoever stopped it settles it
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
    return KinedexError(_told(failure))


def _told(failure: BaseException) -> str:
    """Its kind only: a text may quote what a file or a key says; the log has it."""
    return f"The work failed unexpectedly ({type(failure).__name__}); see the log."
