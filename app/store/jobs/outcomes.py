"""How work ends: job, clip and import change together, in one transaction.

Every acknowledged clip ends once, as ready or as failed with its reason, whatever happens to
its job: success, bad content, cancellation, or a worker that dies each time it tries.

A clip that was ready stays ready, with its earlier analysis and a warning, where another
analysis of it fails. Only the content's own verdict, after a client changed what the analysis
depends on, makes it failed.
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

MOST_KILLS = 8
"""A job whose child process is killed from outside so often is tried once more, alone."""
KILL_DELAY_S = 0.5
"""Before the first new try; doubled each time."""
NOT_REANALYZED = "reanalysis_failed"
"""Code of the warning of a clip that keeps an earlier analysis."""


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
    for job_id, ended in imports.waiting_on(tx, clip_ids).items():
        imports.settle_if_done(tx, job_id, ended)


def fail_job(
    tx: Tx, claimed: ClaimedJob, problem: dict[str, Any], *, is_verdict: bool = False
) -> JobRecord:
    """The job is given up, its clip with it. Raises LeaseLost.

    is_verdict: the content itself is bad, and no failure of the machine.
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
    most: int | None = None,
) -> JobRecord:
    """For failures that may pass (a full disk): later again, until there were too many.

    most: how many failures end the job, by default its `max_attempts`. Raises LeaseLost.
    """
    failures = jobs.get_row(tx, claimed.job.id)["failures"] + 1
    if failures >= (most or claimed.max_attempts):
        return fail_job(tx, claimed, problem)
    waiting = leases.retry_later(tx, claimed.lease, delay_s, failures=failures)
    _wait_again(tx, claimed.clip_id)
    return waiting


def retry_after_kill(tx: Tx, claimed: ClaimedJob, problem: dict[str, Any]) -> JobRecord:
    """Its child process was killed from outside: try again, without counting it as a failure.

    After MOST_KILLS in a row it is tried alone; `problem` is the reason if that fails too.
    Raises LeaseLost.
    """
    kills = jobs.get_row(tx, claimed.job.id)["kills"] + 1
    if kills > MOST_KILLS:
        return fail_job(tx, claimed, problem)
    delay_s = KILL_DELAY_S * 2 ** (kills - 1)
    waiting = leases.retry_later(tx, claimed.lease, delay_s, kills=kills)
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
    if row["owner"] is not None and not owners.is_gone(row["owner"]):
        return _update_job(tx, job_id, cancel_requested=True)
    canceled = _cancel_now(tx, job_id)
    _cancel_what_hangs_on(tx, job, row["clip_id"])
    return canceled


def recover(tx: Tx, abandoned: ClaimedJob) -> JobRecord:
    """Puts a job of a dead worker back into the queue, or ends it.

    It ends where that was asked for, and after `max_attempts` deaths without progress. The
    caller holds it, from `Watch.take`.
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
    """Deletes a clip; its jobs are canceled, imports do not wait for it any more.

    Its files are removed once the transaction is committed. Returns what it was.
    """
    imports_of_it = imports.waiting_on(tx, [clip_id])
    gone = clips.delete_clip(tx, clip_id)
    for job_id in _open_jobs_of(tx, clip_id):
        _cancel_now(tx, job_id)  # a worker that has it will find its lease lost
    for job_id, ended in imports_of_it.items():
        imports.settle_if_done(tx, job_id, ended)
    removals.record(tx, (gone.sha256, gone.skeleton_sha256, gone.audio_sha256))
    return gone


def _cancel_what_hangs_on(tx: Tx, job: JobRecord, clip_id: str | None) -> None:
    _fail_clip(tx, clip_id, Canceled("The analysis was canceled").as_problem())
    if job.kind is JobKind.IMPORT:
        for batch in clips.in_batches(imports.waiting_clips(tx, job.id)):
            _cancel_analyses(tx, batch)


def _cancel_analyses(tx: Tx, clip_ids: list[str]) -> None:
    """As request_cancel does for each analysis of these clips, which wait for one: but together,
    because an import may have a hundred thousand."""
    theirs = update(t.jobs).where(
        t.jobs.c.clip_id.in_(clip_ids), t.jobs.c.state.in_(jobs.open_states())
    )
    tx.execute(theirs.where(t.jobs.c.owner.is_not(None)).values(cancel_requested=True))
    ended = theirs.where(t.jobs.c.owner.is_(None)).values(_canceled()).returning(t.jobs)
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
        clips.keep_analysis(tx, clip.id, _why_not_anew(problem))
    settle_imports(tx, [clip.id])


def _why_not_anew(problem: dict[str, Any]) -> ClipWarning:
    """What a clip says that keeps its earlier analysis."""
    reason = str(problem.get("detail", "")).rstrip(".")
    if problem.get("code") != StoredFileMissing.code:
        told = f"The clip was not analyzed again: {reason}. It keeps its earlier analysis."
        return ClipWarning(NOT_REANALYZED, told)
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
