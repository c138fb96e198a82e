"""Waits for jobs, and follows them as server-sent events."""

from __future__ import annotations

import asyncio
import json
import time
from collections.abc import AsyncIterator, Callable, Iterator
from typing import TypeAlias

from kinedex.call import path_of
from kinedex.errors import JobFailed, places_of
from kinedex.groups import JobsBase
from kinedex.methods import AsyncSender, Sender
from kinedex.types.jobs import Job

FIRST_PAUSE_S = 0.1
LAST_PAUSE_S = 2.0
PAUSE_GROWTH = 1.5
OPEN = frozenset({"queued", "processing"})
EVENTS_PATH = "/v1/jobs/{job_id}/events"

OnProgress: TypeAlias = Callable[[Job], None]


class _Wait:
    """The state of a wait: pauses that grow, and the end of the time."""

    def __init__(self, job_id: str, timeout: float | None, on_progress: OnProgress | None) -> None:
        self._job_id = job_id
        self._end = None if timeout is None else time.monotonic() + timeout
        self._on_progress = on_progress
        self._pause = FIRST_PAUSE_S

    def is_over(self, job: Job, check: bool) -> bool:
        """Whether the job has ended. Raises JobFailed and TimeoutError."""
        if self._on_progress is not None:
            self._on_progress(job)
        if job.state not in OPEN:
            if check and job.state != "succeeded":
                raise failure_of_job(job)
            return True
        if self._end is not None and time.monotonic() >= self._end:
            raise TimeoutError(f"the job {self._job_id} has not ended in time")
        return False

    def next_pause(self) -> float:
        """Seconds until the job is read again."""
        pause, self._pause = self._pause, min(self._pause * PAUSE_GROWTH, LAST_PAUSE_S)
        return pause if self._end is None else min(pause, max(self._end - time.monotonic(), 0.0))


def failure_of_job(job: Job) -> JobFailed:
    """The failure of a job that failed or was canceled."""
    problem = {} if job.error is None else job.error.to_json()
    return JobFailed(
        problem.get("detail") or f"The job {job.id} is {job.state}.",
        job_id=job.id,
        status=problem.get("status") or 0,
        code=problem.get("code") or job.state,
        title=problem.get("title") or "The job failed",
        errors=places_of(problem),
    )


class Jobs(JobsBase[Sender]):
    """Jobs: work in the background."""

    def wait(
        self,
        job_id: str,
        *,
        timeout: float | None = None,
        on_progress: OnProgress | None = None,
        check: bool = True,
    ) -> Job:
        """Wait until a job has ended, and return it.

        timeout: seconds; None waits without limit. on_progress: called with each state of the job.
        Raises JobFailed if the job failed or was canceled (unless `check` is false), TimeoutError.
        """
        wait = _Wait(job_id, timeout, on_progress)
        while not wait.is_over(job := self.get(job_id), check):
            time.sleep(wait.next_pause())
        return job

    def follow(self, job_id: str) -> Iterator[Job]:
        """Each change of a job until it ends, as the service sends them (server-sent events)."""
        for line in self.sender.lines(path_of(EVENTS_PATH, job_id=job_id)):
            if line.startswith("data:"):
                yield Job.from_json(json.loads(line.removeprefix("data:")))


class AsyncJobs(JobsBase[AsyncSender]):
    """Jobs: work in the background."""

    async def wait(
        self,
        job_id: str,
        *,
        timeout: float | None = None,
        on_progress: OnProgress | None = None,
        check: bool = True,
    ) -> Job:
        """Wait until a job has ended, and return it.

        timeout: seconds; None waits without limit. on_progress: called with each state of the job.
        Raises JobFailed if the job failed or was canceled (unless `check` is false), TimeoutError.
        """
        wait = _Wait(job_id, timeout, on_progress)
        while not wait.is_over(job := await self.get(job_id), check):
            await asyncio.sleep(wait.next_pause())
        return job

    async def follow(self, job_id: str) -> AsyncIterator[Job]:
        """Each change of a job until it ends, as the service sends them (server-sent events)."""
        async for line in self.sender.lines(path_of(EVENTS_PATH, job_id=job_id)):
            if line.startswith("data:"):
                yield Job.from_json(json.loads(line.removeprefix("data:")))
