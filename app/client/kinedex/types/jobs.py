"""Answers: jobs. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Any

from kinedex.records import Page, Record
from kinedex.types.choices import FileOutcome, JobKind, JobState
from kinedex.types.clip_remarks import ClipWarning, Difference
from kinedex.types.problem import Problem


@dataclass(frozen=True, slots=True)
class Job(Record):
    """Work in the background.

    clip_id: The clip that the job analyzes. null for other work, and after the clip was
    deleted.
    detail: The current step, as a text for people.
    result: The result. Its members depend on `kind`. An import has the number of files by
    outcome (`total`, `new`, `updated`, `unchanged`, `conflicting`, `failed`, `skipped`,
    `deleted`, `absent`), the number of files that its pattern of paths does not match
    (`unmatched`), the number of clips by the code of their `warnings`, its first 100 `files`
    (files with problems first), and the number of the other files (`files_left_out`). `GET
    .../files` lists all files. Lists of jobs leave `files` out.
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
    error: Problem | None


@dataclass(frozen=True, slots=True)
class JobFile(Record):
    """A file of an import.

    path: Path in the archive or folder.
    outcome: queued, processing or ready: the state of the new clip. updated, unchanged or
    conflicting: the library already had the content; labels that came now were applied, were
    the same, or were not applied because somebody edited them since. failed: there is no clip,
    or the clip cannot be analyzed. skipped: the file is not a motion. deleted: the clip was
    deleted later. absent: a manifest names the file, but the file is missing.
    error: The reason why it failed, else null.
    differences: Labels and hints that differed from those of the stored clip.
    warnings: The warnings of its clip now.
    """

    path: str
    outcome: FileOutcome
    clip_id: str | None
    error: Problem | None
    differences: list[Difference]
    warnings: list[ClipWarning]


@dataclass(frozen=True, slots=True)
class JobFileList(Page[JobFile]):
    """A page of an import's files, by path.

    next: Cursor of the next page, null on the last page.
    total: Number of items on all pages.
    total_is_exact: False if `total` is an estimate, as in lists of over 100,000 items. Its
    standard deviation is 1 %.
    """

    next: str | None
    total: int
    total_is_exact: bool
    items: list[JobFile]


@dataclass(frozen=True, slots=True)
class JobList(Page[Job]):
    """A page of jobs, newest first.

    next: Cursor of the next page, null on the last page.
    total: Number of items on all pages.
    total_is_exact: False if `total` is an estimate, as in lists of over 100,000 items. Its
    standard deviation is 1 %.
    """

    next: str | None
    total: int
    total_is_exact: bool
    items: list[Job]


@dataclass(frozen=True, slots=True)
class JobStarted(Record):
    """The job that a call has queued."""

    job: Job
