"""The outcomes of jobs: job, clip and import change together, in one transaction.

Every clip that was accepted ends exactly once, as ready or as failed with a reason. That is true
for each end of its job: success, bad content, cancellation, or a worker that dies at each attempt.

If another analysis of a ready clip fails, the clip stays ready with its earlier analysis and a
warning. It becomes failed only if a client has changed the input of the analysis, and the content
is the cause of the failure.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

from numpy.typing import NDArray
from sqlalchemy import select, update

from app.errors import Canceled, StoredFileMissing, WorkerDied
from app.store.clips import arrays as array_repository
from app.store.clips import repository as clips
from app.store.clips.record import ClipFacts, ClipRecord, ClipState, ClipWarning
from app.store.database import tables as t
from app.store.database.engine import Tx
from app.store.database.ids import utc_now
from app.store.jobs import endings, imports, leases, owners, removals
from app.store.jobs import repository as jobs
from app.store.jobs.record import ClaimedJob, JobKind, JobRecord, JobState, Lease

MAX_KILLS = 8
"""After this number of kills of its child process from outside, a job is tried once more, alone."""
KILL_DELAY_S = 0.5
"""Time before the first attempt after a kill; it doubles with each kill."""
NOT_REANALYZED = "reanalysis_failed"
"""Code of the warning on a clip that keeps its earlier analysis."""


def finish_ingest(
    tx: Tx,
    lease: Lease,
    clip_id: str,
    facts: ClipFacts,
    arrays: Mapping[str, NDArray[Any]],
    *,
    settles_imports: bool = True,
) -> None:
    """Makes the clip ready and stores its facts and arrays, which replace the earlier ones.

    With `settles_imports=False` the caller calls `settle_imports` itself, once for many clips.
    Raises LeaseLost, before any change, if the caller does not have the job any more.
    """
    leases.succeed(tx, lease, {"clip_id": clip_id})
    array_repository.put_many(tx, clip_id, arrays, version=facts.analysis_version)
    clips.set_ready(tx, clip_id, facts)
    if settles_imports:
        settle_imports(tx, [clip_id])


def settle_imports(tx: Tx, clip_ids: Collection[str]) -> None:
    """Ends the imports whose last clips have ended; updates the progress of the others."""
    for job_id, ended in imports.waiting_on(tx, clip_ids).items():
        imports.settle_if_done(tx, job_id, ended)


def fail_job(
    tx: Tx, claimed: ClaimedJob, problem: dict[str, Any], *, is_verdict: bool = False
) -> JobRecord:
    """The job and its clip fail for good. Raises LeaseLost.

    is_verdict: the cause is the content of the clip, not the machine.
    """
    failed = leases.fail(tx, claimed.lease, problem)
    _fail_clip(tx, claimed.clip_id, problem, is_verdict=is_verdict)
    return failed


def retry_or_fail(
    tx: Tx,
    claimed: ClaimedJob,
    problem: dict[str, Any],
    *,
    delay_s: float,
    max_failures: int | None = None,
) -> JobRecord:
    """Queues the job again after a failure that may be temporary, such as a full disk.

    max_failures: the number of failures after which the job fails for good, by default its
    `max_attempts`. Raises LeaseLost.
    """
    failures = jobs.get_row(tx, claimed.job.id)["failures"] + 1
    if failures >= (max_failures or claimed.max_attempts):
        return fail_job(tx, claimed, problem)
    waiting = leases.retry_later(tx, claimed.lease, delay_s, failures=failures)
    _wait_again(tx, claimed.clip_id)
    return waiting


def retry_after_kill(tx: Tx, claimed: ClaimedJob, problem: dict[str, Any]) -> JobRecord:
    """Queues the job again after its child process was killed from outside.

    A kill is not counted as a failure. After MAX_KILLS kills without progress the job is tried
    alone, and if its child is killed then too, it fails with `problem`. Raises LeaseLost.
    """
    kills = jobs.get_row(tx, claimed.job.id)["kills"] + 1
    if kills > MAX_KILLS:
        return fail_job(tx, claimed, problem)
    delay_s = KILL_DELAY_S * 2 ** (kills - 1)
    waiting = leases.retry_later(tx, claimed.lease, delay_s, kills=kills)
    _wait_again(tx, claimed.clip_id)
    return waiting


def give_back(tx: Tx, claimed: ClaimedJob) -> JobRecord:
    """Puts the job of a worker that stops back into the queue. Raises LeaseLost."""
    queued = leases.give_back(tx, claimed.lease)
    _wait_again(tx, claimed.clip_id)
    return queued


def finish_canceled(tx: Tx, claimed: ClaimedJob) -> JobRecord:
    """Ends a job whose worker stopped because of a request to cancel. Raises LeaseLost."""
    canceled = leases.end_canceled(tx, claimed.lease)
    _cancel_dependents(tx, claimed.job, claimed.clip_id)
    return canceled


def request_cancel(tx: Tx, job_id: str) -> JobRecord:
    """Cancels a job that no living worker has; otherwise asks its worker to cancel it.

    A job that has ended does not change. Raises JobNotFound.
    """
    row = jobs.get_row(tx, job_id)
    job = jobs.to_record(row)
    if not job.is_open:
        return job
    if row["owner"] is not None and not owners.is_gone(row["owner"]):
        return _update_job(tx, job_id, cancel_requested=True)
    canceled = _cancel_now(tx, job_id)
    _cancel_dependents(tx, job, row["clip_id"])
    return canceled


def recover(tx: Tx, abandoned: ClaimedJob) -> JobRecord:
    """Puts a job of a dead worker back into the queue, or ends it.

    It ends if a client asked to cancel it, and after `max_attempts` deaths without progress. The
    caller must have taken the job by `Watch.take`.
    """
    if abandoned.cancel_requested:
        return finish_canceled(tx, abandoned)
    times = abandoned.worker_deaths
    if times < abandoned.max_attempts:
        return give_back(tx, abandoned)
    often = "The worker died" if times == 1 else f"The worker died {times} times"
    died = WorkerDied(f"{often} while it worked on this, so it was given up")
    return fail_job(tx, abandoned, died.as_problem())


def remove_clip(tx: Tx, clip_id: str) -> ClipRecord:
    """Deletes a clip and cancels its jobs; imports do not wait for it any more.

    Its files are removed after the commit. Returns its last record. Raises ClipNotFound.
    """
    # Before the deletion, which removes the clip's id from the entries of the imports.
    waiting_imports = imports.waiting_on(tx, [clip_id])
    deleted = clips.delete_clip(tx, clip_id)
    for job_id in _open_jobs_of(tx, clip_id):
        _cancel_now(tx, job_id)  # a worker that has the job will get LeaseLost
    for job_id, ended in waiting_imports.items():
        imports.settle_if_done(tx, job_id, ended)
    removals.record(tx, (deleted.sha256, deleted.skeleton_sha256, deleted.audio_sha256))
    return deleted


def _cancel_dependents(tx: Tx, job: JobRecord, clip_id: str | None) -> None:
    """Fails the clip of a canceled job; cancels the analyses of a canceled import."""
    _fail_clip(tx, clip_id, Canceled("The analysis was canceled").as_problem())
    if job.kind is JobKind.IMPORT:
        for batch in clips.in_batches(imports.waiting_clips(tx, job.id)):
            _cancel_analyses(tx, batch)


def _cancel_analyses(tx: Tx, clip_ids: list[str]) -> None:
    """Does what `request_cancel` does, for the analyses of many clips in a few statements.

    An import may have a hundred thousand clips.
    """
    open_jobs = update(t.jobs).where(
        t.jobs.c.clip_id.in_(clip_ids), t.jobs.c.state.in_(jobs.open_states())
    )
    tx.execute(open_jobs.where(t.jobs.c.owner.is_not(None)).values(cancel_requested=True))
    ended = open_jobs.where(t.jobs.c.owner.is_(None)).values(_canceled()).returning(t.jobs)
    rows = tx.execute(ended).mappings().all()
    endings.announce(tx, rows)
    failed = [row["clip_id"] for row in rows]
    clips.fail_waiting(tx, failed, Canceled("The analysis was canceled").as_problem())
    settle_imports(tx, failed)


def _fail_clip(
    tx: Tx, clip_id: str | None, problem: dict[str, Any], *, is_verdict: bool = False
) -> None:
    clip = None if clip_id is None else clips.get_many(tx, [clip_id]).get(clip_id)
    if clip is None:
        return
    if clip.state is not ClipState.READY or (is_verdict and clip.is_changed):
        clips.set_failed(tx, clip.id, problem)
    else:
        clips.keep_analysis(tx, clip.id, _reanalysis_warning(problem))
    settle_imports(tx, [clip.id])


def _reanalysis_warning(problem: dict[str, Any]) -> ClipWarning:
    """The warning on a clip that keeps its earlier analysis."""
    reason = str(problem.get("detail", "")).rstrip(".")
    if problem.get("code") != StoredFileMissing.code:
        detail = f"The clip was not analyzed again: {reason}. It keeps its earlier analysis."
        return ClipWarning(NOT_REANALYZED, detail)
    return ClipWarning(
        StoredFileMissing.code,
        f"{reason}. The clip cannot be analyzed again and keeps its earlier analysis. Put the"
        " file back from a backup, then run `kinedex reanalyze`.",
    )


def _wait_again(tx: Tx, clip_id: str | None) -> None:
    if clip_id is not None:
        clips.wait_again(tx, clip_id)


def _open_jobs_of(tx: Tx, clip_id: str) -> list[str]:
    query = select(t.jobs.c.id).where(
        t.jobs.c.clip_id == clip_id, t.jobs.c.state.in_(jobs.open_states())
    )
    return list(tx.execute(query).scalars())


def _cancel_now(tx: Tx, job_id: str) -> JobRecord:
    canceled = _update_job(tx, job_id, **_canceled())
    endings.announce(tx, [jobs.get_row(tx, job_id)])
    return canceled


def _canceled() -> dict[str, Any]:
    return {
        "state": JobState.CANCELED.value,
        "finished_at": utc_now(),
        "owner": None,
        "dedupe_key": None,
    }


def _update_job(tx: Tx, job_id: str, **values: Any) -> JobRecord:
    changed = update(t.jobs).where(t.jobs.c.id == job_id).values(**values).returning(t.jobs)
    return jobs.to_record(tx.execute(changed).mappings().one())
