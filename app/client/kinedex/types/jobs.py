"""Answers: jobs. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Any

from kinedex.records import Page, Record
from kinedex.types.choices import FileOutcome, JobKind, JobState
from kinedex.types.problem import Problem


@dataclass(frozen=True, slots=True)
class Job(Record):
    """Work in the background.

    detail: The current step, as a text for people.
    result: The result. Its members depend on `kind`. An import has the number of files by
    outcome (`total`, `ready`, `exists`, `failed`, `deleted`, `absent`), its first 100 `files`
    (failed files first), and the number of the other files (`files_left_out`). `GET .../files`
    lists all files. Lists of jobs leave `files` out.
    """

    id: str
    kind: JobKind
    state: JobState
    progress: float
    detail: str | None
    created_at: datetime
    started_at: datetime | None
    finished_at: datetime | None
    result: dict[str, Any] | None
    error: Problem | None


@dataclass(frozen=True, slots=True)
class JobFile(Record):
    """A file of an import.

    path: Path in the archive or folder.
    outcome: queued, processing or ready: the state of the clip. failed: there is no clip, or
    the clip cannot be analyzed. exists: the library already had the content. deleted: the clip
    was deleted later. absent: a manifest names the file, but the file is missing.
    error: The reason why it failed, else null.
    """

    path: str
    outcome: FileOutcome
    clip_id: str | None
    error: Problem | None


@dataclass(frozen=True, slots=True)
class JobFileList(Page[JobFile]):
    """A page of an import's files, by path."""

    items: list[JobFile]
    next: str | None


@dataclass(frozen=True, slots=True)
class JobList(Page[Job]):
    """A page of jobs, newest first."""

    items: list[Job]
    next: str | None


@dataclass(frozen=True, slots=True)
class JobStarted(Record):
    """The job that a call has queued."""

    job: Job
