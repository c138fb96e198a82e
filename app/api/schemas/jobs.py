"""Jobs."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from app.api.failures.problems import stored_problem
from app.api.schemas.base import Cursor, Incoming, Limit, Outgoing
from app.api.schemas.problem import KeptProblem
from app.store.jobs.import_files import FileOutcome
from app.store.jobs.record import JobKind, JobState


def _result(kept: dict[str, Any] | None) -> dict[str, Any] | None:
    """The result, with the failure of each file completed to a whole problem."""
    if kept is None or "files" not in kept:
        return kept
    files = [{**line, "error": _problem(line["error"])} for line in kept["files"]]
    return {**kept, "files": files}


def _problem(kept: dict[str, Any] | None) -> dict[str, Any] | None:
    return None if kept is None else stored_problem(kept)


class Job(Outgoing):
    """Work that is done in the background."""

    id: str
    kind: JobKind
    state: JobState
    progress: float = Field(ge=0, le=1)
    detail: str | None = Field(description="What is being done, for people.")
    created_at: datetime
    started_at: datetime | None
    finished_at: datetime | None
    result: Annotated[dict[str, Any] | None, BeforeValidator(_result)] = Field(
        description="What came of it; its members by `kind`. Of an import: how many files came to"
        " what (`total`, `ready`, `exists`, `failed`, `deleted`, `absent`), its first 100 `files`"
        " (failed ones before others), and how many there are beside them (`files_left_out`);"
        " `GET .../files` has them all. Lists of jobs leave `files` out."
    )
    error: KeptProblem


class JobFile(Outgoing):
    """A file of an import."""

    path: str = Field(description="Where it is in the archive or folder.")
    outcome: FileOutcome = Field(
        description="queued, processing or ready: the clip's state; failed: no clip, or one that"
        " cannot be analyzed; exists: the library held the content before; deleted: the clip was"
        " deleted since; absent: a manifest names it, and it is not there."
    )
    clip_id: str | None
    error: KeptProblem = Field(description="Why it failed.")


class JobFileList(Outgoing):
    """A page of an import's files, by path."""

    items: list[JobFile]
    next: str | None


class JobFileQuery(Incoming):
    """Which files of an import are listed, and which page of them."""

    outcome: FileOutcome | None = None
    limit: Limit = 100
    cursor: Cursor | None = None


class JobList(Outgoing):
    """A page of jobs, newest first."""

    items: list[Job]
    next: str | None


class JobStarted(Outgoing):
    """The job that a call has queued."""

    job: Job


class JobQuery(Incoming):
    """Filters of the list of jobs, and which page of it."""

    kind: JobKind | None = None
    state: JobState | None = None
    limit: Limit = 10
    cursor: Cursor | None = None
