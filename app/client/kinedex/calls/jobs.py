"""Calls: jobs. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kinedex.call import Call, path_of, record, record_if_any
from kinedex.sent import given

if TYPE_CHECKING:
    from kinedex.types.choices import FileOutcome, JobKind, JobState
    from kinedex.types.jobs import Job, JobFileList, JobList


def list_jobs(
    *,
    kind: JobKind | None = None,
    state: JobState | None = None,
    limit: int | None = None,
    cursor: str | None = None,
) -> Call[JobList]:
    """Jobs, the newest first.

    limit: Maximum number of items in all; None lists all.
    cursor: Where the list starts: `next` of an earlier page.
    """
    from kinedex.types.jobs import JobList

    return Call(
        "list_jobs",
        "GET",
        "/v1/jobs",
        record(JobList),
        query=given(kind=kind, state=state, limit=limit, cursor=cursor),
    )


def get_job(job_id: str) -> Call[Job]:
    """One job."""
    from kinedex.types.jobs import Job

    return Call("get_job", "GET", path_of("/v1/jobs/{job_id}", job_id=job_id), record(Job))


def cancel_or_delete_job(job_id: str) -> Call[Job | None]:
    """Cancel an open job, or delete a job that has ended. No clip is deleted.

    The newest fit cannot be deleted (409), because it says what the models have learned. Kinedex
    also deletes ended jobs after `KINEDEX_JOB_RETENTION_DAYS` days.
    """
    from kinedex.types.jobs import Job

    return Call(
        "cancel_or_delete_job",
        "DELETE",
        path_of("/v1/jobs/{job_id}", job_id=job_id),
        record_if_any(Job),
    )


def list_files(
    job_id: str,
    *,
    outcome: FileOutcome | None = None,
    limit: int | None = None,
    cursor: str | None = None,
) -> Call[JobFileList]:
    """The outcome of each file of an import, by path.

    If a manifest names missing files, only the first 100 of them are listed. The job's result
    counts all of them. Other jobs have no files.

    limit: Maximum number of items in all; None lists all.
    cursor: Where the list starts: `next` of an earlier page.
    """
    from kinedex.types.jobs import JobFileList

    return Call(
        "list_files",
        "GET",
        path_of("/v1/jobs/{job_id}/files", job_id=job_id),
        record(JobFileList),
        query=given(outcome=outcome, limit=limit, cursor=cursor),
    )
