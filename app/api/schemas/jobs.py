"""Jobs."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from app.api.failures.problems import stored_problem
from app.api.schemas.base import Cursor, Incoming, Limit, Outgoing, Paged
from app.api.schemas.clip_remarks import ClipWarning, Difference
from app.api.schemas.problem import StoredProblem
from app.store.jobs.import_files import FileOutcome
from app.store.jobs.record import JobKind, JobState


def _result(stored: dict[str, Any] | None) -> dict[str, Any] | None:
    """Complete the failure of each file in a result to a problem."""
    if stored is None or "files" not in stored:
        return stored
    files = [{**line, "error": _problem(line["error"])} for line in stored["files"]]
    return {**stored, "files": files}


def _problem(stored: dict[str, Any] | None) -> dict[str, Any] | None:
    return None if stored is None else stored_problem(stored)


class Job(Outgoing):
    """Work in the background."""

    id: str
    kind: JobKind
    state: JobState
    clip_id: str | None = Field(
        description="The clip that the job analyzes. null for other work, and after the clip was"
        " deleted."
    )
    progress: float = Field(ge=0, le=1)
    detail: str | None = Field(description="The current step, as a text for people.")
    created_at: datetime
    started_at: datetime | None
    finished_at: datetime | None
    result: Annotated[dict[str, Any] | None, BeforeValidator(_result)] = Field(
        description="The result. Its members depend on `kind`. An import has the number of files by"
        " outcome (`total`, `new`, `updated`, `unchanged`, `conflicting`, `failed`, `skipped`,"
        " `deleted`, `absent`), the number of files that its pattern of paths does not match"
        " (`unmatched`), the number of clips by the code of their `warnings`, its first 100 `files`"
        " (files with problems first), and the number of the other files (`files_left_out`)."
        " `GET .../files` lists all files. Lists of jobs leave `files` out."
    )
    error: StoredProblem


class JobFile(Outgoing):
    """A file of an import."""

    path: str = Field(description="Path in the archive or folder.")
    outcome: FileOutcome = Field(
        description="queued, processing or ready: the state of the new clip. updated, unchanged or"
        " conflicting: the library already had the content; labels that came now were applied, were"
        " the same, or were not applied because somebody edited them since. failed: there is no"
        " clip, or the clip cannot be analyzed. skipped: the file is not a motion. deleted: the"
        " clip was deleted later. absent: a manifest names the file, but the file is missing."
    )
    clip_id: str | None
    error: StoredProblem = Field(description="The reason why it failed, else null.")
    differences: list[Difference] = Field(
        description="Labels and hints that differed from those of the stored clip."
    )
    warnings: list[ClipWarning] = Field(description="The warnings of its clip now.")


class JobFileList(Paged):
    """A page of an import's files, by path."""

    items: list[JobFile]


class JobFileQuery(Incoming):
    """A filter of an import's files, and a page of them."""

    outcome: FileOutcome | None = None
    limit: Limit = 100
    cursor: Cursor | None = None


class JobList(Paged):
    """A page of jobs, newest first."""

    items: list[Job]


class JobStarted(Outgoing):
    """The job that a call has queued."""

    job: Job


class JobQuery(Incoming):
    """Filters of the list of jobs, and a page of it."""

    kind: JobKind | None = None
    state: JobState | None = None
    limit: Limit = 10
    cursor: Cursor | None = None
