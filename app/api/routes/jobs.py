"""Jobs: list, read, cancel or delete, and follow as server-sent events."""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import Annotated

import anyio
from fastapi import APIRouter, Depends, Query, Request, Response
from fastapi.concurrency import run_in_threadpool
from fastapi.sse import EventSourceResponse, ServerSentEvent

from app.api.deps import Lib, reads, writes
from app.api.guard.admission import changes, follow, quick
from app.api.openapi import JobId, refusals
from app.api.schemas.jobs import Job, JobFileList, JobFileQuery, JobList, JobQuery
from app.errors import Conflict, JobNotFound
from app.services.clips import jobs
from app.services.library.library import Library
from app.store.jobs.record import JobRecord

router = APIRouter(prefix="/v1/jobs", tags=["jobs"])

POLL_SECONDS = 0.25
"""Time between two reads of a job for a client that follows it."""


@router.get("", dependencies=[reads, quick], responses=refusals(404))
def list_jobs(lib: Lib, query: Annotated[JobQuery, Query()]) -> JobList:
    """Jobs, the newest first."""
    page = jobs.list_jobs(lib, query.kind, query.state, query.limit, query.cursor)
    return JobList.model_validate(page)


@router.get("/{job_id}", dependencies=[reads, quick], responses=refusals(404))
def get_job(lib: Lib, job_id: JobId) -> Job:
    """One job."""
    return Job.model_validate(jobs.get_job(lib, job_id))


@router.get("/{job_id}/files", dependencies=[reads, quick], responses=refusals(404))
def list_files(lib: Lib, job_id: JobId, query: Annotated[JobFileQuery, Query()]) -> JobFileList:
    """The outcome of each file of an import, by path.

    If a manifest names missing files, only the first 100 of them are listed. The job's result
    counts all of them. Other jobs have no files.
    """
    page = jobs.list_files(lib, job_id, query.outcome, query.limit, query.cursor)
    return JobFileList.model_validate(page)


@router.delete(
    "/{job_id}",
    status_code=202,
    dependencies=[writes, changes],
    response_model=Job,
    responses={
        **refusals(404, Conflict),
        202: {"description": "The job had not ended: it is canceled, or stops soon."},
        204: {"description": "The job had ended: it is deleted, with the list of its files."},
    },
)
def cancel_or_delete_job(lib: Lib, job_id: JobId) -> Job | Response:
    """Cancel an open job, or delete a job that has ended. No clip is deleted.

    The newest fit cannot be deleted (409), because it says what the models have learned. Kinedex
    also deletes ended jobs after `KINEDEX_JOB_RETENTION_DAYS` days.
    """
    canceled = jobs.cancel_or_remove(lib, job_id)
    return Response(status_code=204) if canceled is None else Job.model_validate(canceled)


def _existing(lib: Lib, job_id: JobId) -> JobRecord:
    # A dependency runs before the stream begins, when we can still answer 404.
    return jobs.get_job(lib, job_id)


@router.get(
    "/{job_id}/events",
    dependencies=[reads, Depends(_existing), follow],
    response_class=EventSourceResponse,
    responses=refusals(404),
)
async def follow_job(
    request: Request, lib: Lib, job: Annotated[JobRecord, Depends(_existing)]
) -> AsyncIterator[ServerSentEvent]:
    """Follow a job: an event `progress` for each change, and `done` when the job has ended.

    The data of every event is the Job. The stream ends after `done`. If it ends without `done`,
    the service was restarted, and the client can open the stream again.
    """
    sent: JobRecord | None = None
    current: JobRecord | None = job
    while current is not None and current.is_open:
        if current != sent:
            yield ServerSentEvent(event="progress", data=Job.model_validate(current))
        sent = current
        await anyio.sleep(POLL_SECONDS)
        if request.app.state.stopping:
            return
        current = await run_in_threadpool(_job_if_any, lib, job.id)
    yield ServerSentEvent(event="done", data=Job.model_validate(current or job))


def _job_if_any(lib: Library, job_id: str) -> JobRecord | None:
    try:
        return jobs.get_job(lib, job_id)
    except JobNotFound:  # deleted meanwhile: it had ended
        return None
