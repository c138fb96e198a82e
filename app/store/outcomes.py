"""How work ends: job, clip and import change together, in one transaction.

Every acknowledged clip ends once, as ready or as failed with its reason, whatever happens to
its job: success, bad content, cancellation, or a worker that dies each time it tries.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

from numpy.typing import NDArray
from sqlalchemy import select, update

from app.errors import Canceled, WorkerDied
from app.store import arrays as array_repository
from app.store import clips, imports, jobs, leases, removals
from app.store import tables as t
from app.store.clip_record import ClipFacts, ClipRecord, ClipState
from app.store.engine import Tx
from app.store.ids import utc_now
from app.store.job_record import ClaimedJob, JobKind, JobRecord, JobState, Lease


def finish_ingest(
    tx: Tx,
    lease: Lease,
    clip_id: str,
    facts: ClipFacts,
    found: Mapping[str, NDArray[Any]],
    *,
    settles_imports: bool = True,
) -> None:
    """The clip is ready, with what was found; its arrays replace those of an earlier analysis.

    Raises LeaseLost, before anything is changed, when the job is no longer the caller's.
    `settles_imports=False` leaves `settle_imports` to the caller, once for many clips.
    """
    leases.succeed(tx, lease, {"clip_id": clip_id})
    array_repository.put_many(tx, clip_id, found, version=facts.analysis_version)
    clips.set_ready(tx, clip_id, facts)
    if settles_imports:
        settle_imports(tx, [clip_id])


def settle_imports(tx: Tx, clip_ids: Collection[str]) -> None:
    """Ends the imports that waited for these clips only; tells the others' progress."""
    for job_id in imports.waiting_on(tx, clip_ids):
        imports.settle_if_done(tx, job_id)


def fail_job(tx: Tx, claimed: ClaimedJob, problem: dict[str, Any]) -> JobRecord:
    """The job is given up, its clip with it. Raises LeaseLost."""
    failed = leases.fail(tx, claimed.lease, problem)
    _fail_clip(tx, claimed.clip_id, problem)
    return failed


def retry_or_fail(
    tx: Tx, claimed: ClaimedJob, problem: dict[str, Any], *, delay_s: float
) -> JobRecord:
    """For failures that may pass (a full disk): later again, until the attempts are used up."""
    row = jobs.get_row(tx, claimed.job.id)
    if claimed.lease.attempt >= row["max_attempts"]:
        return fail_job(tx, claimed, problem)
    waiting = leases.retry_later(tx, claimed.lease, delay_s)
    _wait_again(tx, claimed.clip_id)
    return waiting


def give_back(tx: Tx, claimed: ClaimedJob) -> JobRecord:
    """A worker that is told to stop hands its job to the next one. Raises LeaseLost."""
    queued = leases.give_back(tx, claimed.lease)
    _wait_again(tx, claimed.clip_id)
    return queued


def finish_canceled(tx: Tx, claimed: ClaimedJob) -> JobRecord:
    """The worker has seen the request to cancel and stopped. Raises LeaseLost."""
    canceled = leases.end_canceled(tx, claimed.lease)
    _cancel_what_hangs_on(tx, claimed.job, claimed.clip_id)
    return canceled


def request_cancel(tx: Tx, job_id: str) -> JobRecord:
    """Cancels a job that nobody works on; asks the worker of one that is worked on.

    A job that is over stays as it is. Raises JobNotFound.
    """
    row = jobs.get_row(tx, job_id)
    job = jobs.to_record(row)
    if not job.is_open:
        return job
    if row["owner"] is not None:
        return _update_job(tx, job_id, cancel_requested=True)
    canceled = _cancel_now(tx, job_id)
    _cancel_what_hangs_on(tx, job, row["clip_id"])
    return canceled


def settle_abandoned(tx: Tx) -> tuple[JobRecord, ...]:
    """Ends the jobs whose workers died too often, or died after a request to cancel."""
    return tuple(_settle_one(tx, abandoned) for abandoned in leases.exhausted(tx))


def remove_clip(tx: Tx, clip_id: str) -> ClipRecord:
    """Deletes a clip; its jobs are canceled, imports do not wait for it any more.

    Its files are removed once the transaction is committed. Returns what it was.
    """
    imports_of_it = imports.waiting_on(tx, [clip_id])
    gone = clips.delete_clip(tx, clip_id)
    for job_id in _open_jobs_of(tx, clip_id):
        _cancel_now(tx, job_id)  # a worker that has it will find its lease lost
    for job_id in imports_of_it:
        imports.settle_if_done(tx, job_id)
    removals.record(tx, (gone.sha256, gone.skeleton_sha256, gone.audio_sha256))
    return gone


def _settle_one(tx: Tx, abandoned: ClaimedJob) -> JobRecord:
    row = jobs.get_row(tx, abandoned.job.id)
    if row["cancel_requested"]:
        return finish_canceled(tx, abandoned)
    times = row["attempts"]
    return fail_job(
        tx,
        abandoned,
        WorkerDied(
            f"The worker died {times} times while it worked on this, so it was given up"
            if times != 1
            else "The worker died while it worked on this, so it was given up"
        ).as_problem(),
    )


def _cancel_what_hangs_on(tx: Tx, job: JobRecord, clip_id: str | None) -> None:
    _fail_clip(tx, clip_id, Canceled("The analysis was canceled").as_problem())
    if job.kind is JobKind.IMPORT:
        for entry in imports.entries(tx, job.id):
            if entry.outcome is imports.ImportOutcome.QUEUED and entry.clip_id is not None:
                for job_id in _open_jobs_of(tx, entry.clip_id):
                    request_cancel(tx, job_id)


def _fail_clip(tx: Tx, clip_id: str | None, problem: dict[str, Any]) -> None:
    if clip_id is not None and clip_id in clips.get_many(tx, [clip_id]):
        clips.set_failed(tx, clip_id, problem)
        settle_imports(tx, [clip_id])


def _wait_again(tx: Tx, clip_id: str | None) -> None:
    if clip_id is not None and clips.get(tx, clip_id).state is ClipState.PROCESSING:
        clips.requeue(tx, clip_id)


def _open_jobs_of(tx: Tx, clip_id: str) -> list[str]:
    query = select(t.jobs.c.id).where(
        t.jobs.c.clip_id == clip_id, t.jobs.c.state.in_(jobs.open_states())
    )
    return list(tx.execute(query).scalars())


def _cancel_now(tx: Tx, job_id: str) -> JobRecord:
    return _update_job(
        tx,
        job_id,
        state=JobState.CANCELED.value,
        finished_at=utc_now(),
        owner=None,
        lease_until=None,
        dedupe_key=None,
    )


def _update_job(tx: Tx, job_id: str, **values: Any) -> JobRecord:
    changed = update(t.jobs).where(t.jobs.c.id == job_id).values(**values).returning(t.jobs)
    return jobs.to_record(tx.execute(changed).mappings().one())
