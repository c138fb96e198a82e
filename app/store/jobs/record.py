"""The data of a job in the store."""

from __future__ import annotations

from dataclasses import dataclass, field
from datetime import datetime
from enum import StrEnum
from typing import Any


class JobKind(StrEnum):
    """The kinds of jobs."""

    INGEST = "ingest"
    """Analyze one clip."""
    IMPORT = "import"
    """Unpack an archive into clips, each with its own ingest job."""
    FIT = "fit"
    """Fit the library's models."""
    EVALUATE = "evaluate"
    """Judge the methods on the library's labels."""


class JobState(StrEnum):
    """The state of a job."""

    QUEUED = "queued"
    """The job waits for a worker."""
    PROCESSING = "processing"
    """A worker has the job; or it is an import that waits for its clips."""
    SUCCEEDED = "succeeded"
    """The job is done; `result` holds its result."""
    FAILED = "failed"
    """The job failed for good; `error` says why."""
    CANCELED = "canceled"
    """The job was stopped on request."""


OPEN_STATES = (JobState.QUEUED, JobState.PROCESSING)


@dataclass(frozen=True, slots=True)
class JobRecord:
    """The row of a job without its arguments: the fields that clients see.

    clip_id: the clip that an ingest job analyzes, None for other jobs and after its deletion;
    progress: completed share, 0..1; detail: the progress as a text; result: JSON whose members
    depend on the kind; error: an RFC 9457 problem.
    """

    id: str
    kind: JobKind
    state: JobState
    clip_id: str | None
    progress: float
    detail: str | None
    created_at: datetime
    started_at: datetime | None
    finished_at: datetime | None
    result: dict[str, Any] | None
    error: dict[str, Any] | None

    @property
    def is_open(self) -> bool:
        """Whether the job has not ended yet."""
        return self.state in OPEN_STATES


@dataclass(frozen=True, slots=True)
class NewJob:
    """A job to be queued.

    priority: a lower number is claimed first; clip_id: the clip that an ingest job analyzes;
    file_sha256: a stored file that is not removed while the job is open; payload: its arguments,
    JSON; max_attempts: the number of deaths of its worker, or of failures of the store, without
    progress between them, after which the job fails; dedupe_key: only one job with this key is
    queued at a time.
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
    """The right of a worker to change a job; it ends with the next claim of the job."""

    job_id: str
    owner: str
    attempt: int


@dataclass(frozen=True, slots=True)
class ClaimedJob:
    """A job that a worker has claimed, with its lease and its arguments.

    Three counters since the last progress of the job: failures: failures of the store, and deaths
    of the child process that its own work caused; kills: kills of the child process from outside;
    worker_deaths: deaths of its worker.
    """

    job: JobRecord
    lease: Lease
    file_sha256: str | None
    payload: dict[str, Any]
    max_attempts: int
    failures: int
    kills: int
    worker_deaths: int
    cancel_requested: bool

    @property
    def clip_id(self) -> str | None:
        """The clip that the job analyzes."""
        return self.job.clip_id
