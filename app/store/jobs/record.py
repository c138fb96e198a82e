"""The job as the store tells it: exactly the fields of DESIGN 8's Job."""

from __future__ import annotations

from dataclasses import dataclass, field
from datetime import datetime
from enum import StrEnum
from typing import Any


class JobKind(StrEnum):
    """What a job does."""

    INGEST = "ingest"
    """Analyse one clip."""
    IMPORT = "import"
    """Unpack an archive into clips, each with an ingest job of its own."""
    FIT = "fit"
    """Fit the library's models."""


class JobState(StrEnum):
    """Where a job stands."""

    QUEUED = "queued"
    """Waits for a worker."""
    PROCESSING = "processing"
    """A worker has it; or an import waits for its clips."""
    SUCCEEDED = "succeeded"
    """Done; `result` tells."""
    FAILED = "failed"
    """Given up; `error` says why."""
    CANCELED = "canceled"
    """Stopped on request."""


OPEN_STATES = (JobState.QUEUED, JobState.PROCESSING)


@dataclass(frozen=True, slots=True)
class JobRecord:
    """A job's row. progress: 0..1; result: of the kind's own shape; error: RFC 9457 problem."""

    id: str
    kind: JobKind
    state: JobState
    progress: float
    detail: str | None
    created_at: datetime
    started_at: datetime | None
    finished_at: datetime | None
    result: dict[str, Any] | None
    error: dict[str, Any] | None

    @property
    def is_open(self) -> bool:
        """Whether it has yet to end."""
        return self.state in OPEN_STATES


@dataclass(frozen=True, slots=True)
class NewJob:
    """A job to be queued.

    priority: lower is taken first; clip_id: the clip it is about; file_sha256: a stored file
    that must be kept while it is open; payload: its arguments, JSON; max_attempts: how often its
    worker may die, or the store may fail, without progress in between; dedupe_key: while a job
    with this key is queued, no second one is.
    """

    kind: JobKind
    clip_id: str | None = None
    file_sha256: str | None = None
    payload: dict[str, Any] = field(default_factory=dict)
    priority: int = 0
    max_attempts: int = 3
    dedupe_key: str | None = None


@dataclass(frozen=True, slots=True)
class Lease:
    """A worker's right to a job: void once the job has been given to another, or again."""

    job_id: str
    owner: str
    attempt: int


@dataclass(frozen=True, slots=True)
class ClaimedJob:
    """What a worker gets: the job, the right to it, and its arguments.

    What went wrong with it so far, each counted for itself: failures, which are its own (its
    child process died by its own work) or the store's; kills of its child process from outside;
    worker_deaths, without progress in between.
    """

    job: JobRecord
    lease: Lease
    clip_id: str | None
    file_sha256: str | None
    payload: dict[str, Any]
    max_attempts: int
    failures: int
    kills: int
    worker_deaths: int
    cancel_requested: bool
