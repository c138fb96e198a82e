"""Imports: records the outcome of each file, and ends the import job.

An import job unpacks an archive. Each clip that it adds has its own ingest job. The import ends
when the last of its clips ends. `import_files` reads the recorded files.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from sqlalchemy import bindparam, exists, func, insert, or_, select, update

from app.store.clips import versions as library
from app.store.clips.record import REANALYSIS_OPEN, ClipState, Difference
from app.store.database.engine import Tx
from app.store.database.ids import utc_now
from app.store.database.tables import clips, import_entries, jobs
from app.store.jobs import endings, import_files, leases
from app.store.jobs import repository as job_repository
from app.store.jobs.import_files import FileOutcome, ImportOutcome
from app.store.jobs.record import JobRecord, JobState, Lease

COUNTED = {
    "new": FileOutcome.READY,
    "updated": FileOutcome.UPDATED,
    "unchanged": FileOutcome.UNCHANGED,
    "conflicting": FileOutcome.CONFLICTING,
    "failed": FileOutcome.FAILED,
    "skipped": FileOutcome.SKIPPED,
    "deleted": FileOutcome.DELETED,
    "absent": FileOutcome.ABSENT,
}
"""The members of the result of an ended import that count files, each with the outcome."""
_UNMATCHED = "unmatched"
"""Member of the payload and of the result: how many files the pattern of paths does not match."""
_ABSENT_COUNT = "absent"
"""Member of the payload of an import: the number of absent files that its manifests name."""
_FILES = "files"
"""Member of the payload: the number of recorded files."""
_UNFINISHED = (ClipState.QUEUED.value, ClipState.PROCESSING.value)
_ADD_ENTRIES = insert(import_entries)
# The query begins with the unfinished clips, which are few near the end, not with all files.
_ANY_UNFINISHED = (
    select(clips.c.id)
    .where(
        clips.c.state.in_(_UNFINISHED),
        exists().where(
            import_entries.c.clip_id == clips.c.id,
            import_entries.c.job_id == bindparam("the_id"),
        ),
    )
    .limit(1)
)


@dataclass(frozen=True, slots=True)
class NewEntry:
    """The outcome of a file: a clip with its differences from what came, or an RFC 9457 problem."""

    path: str
    outcome: ImportOutcome
    clip_id: str | None = None
    problem: dict[str, Any] | None = None
    differences: tuple[Difference, ...] = ()


def add_entries(tx: Tx, job_id: str, new: Sequence[NewEntry]) -> None:
    """Records the outcomes of files.

    Call it in the transaction that stores their clips, and once for each path.
    """
    if new:
        rows = [
            {
                "job_id": job_id,
                "path": entry.path,
                "outcome": entry.outcome.value,
                "clip_id": entry.clip_id,
                "problem": entry.problem,
                "differences": [asdict(one) for one in entry.differences] or None,
            }
            for entry in new
        ]
        tx.execute(_ADD_ENTRIES, rows)


def recorded_paths(tx: Tx, job_id: str) -> frozenset[str]:
    """Paths that are recorded already. An import that is taken up again skips them."""
    query = select(import_entries.c.path).where(import_entries.c.job_id == job_id)
    return frozenset(tx.execute(query).scalars())


def has_clip(tx: Tx, job_id: str, clip_id: str) -> bool:
    """Whether an earlier file of an import is recorded with this clip."""
    query = select(import_entries.c.path).where(
        import_entries.c.clip_id == clip_id, import_entries.c.job_id == job_id
    )
    return tx.execute(query.limit(1)).first() is not None


def waiting_clips(tx: Tx, job_id: str) -> tuple[str, ...]:
    """Ids of the clips of an import whose analysis is waiting or running."""
    query = (
        select(import_entries.c.clip_id)
        .join(clips, clips.c.id == import_entries.c.clip_id)
        .where(
            import_entries.c.job_id == job_id,
            import_entries.c.outcome == ImportOutcome.QUEUED.value,
            clips.c.state.in_(_UNFINISHED),
        )
    )
    return tuple(tx.execute(query).scalars())


def requeue_behind_others(
    tx: Tx, lease: Lease, progress: float, detail: str, lowest: int
) -> JobRecord:
    """Puts an import back into the queue, so that other imports get a turn.

    Its priority number grows by one, but not beyond `lowest`, the least urgent one. The progress
    stays, and this does not count as a failed attempt. Raises LeaseLost.
    """
    leases.give_back(tx, lease)
    priority = job_repository.get_row(tx, lease.job_id)["priority"]
    return _update(
        tx,
        lease.job_id,
        priority=max(priority, min(priority + 1, lowest)),
        progress=progress,
        detail=detail,
    )


def wait_for_clips(
    tx: Tx, lease: Lease, detail: str | None = None, *, absent: int = 0, unmatched: int = 0
) -> JobRecord:
    """The archive is unpacked: the job needs no worker any more, and ends with its last clip.

    absent: the number of absent files that the manifests name, including those that are not
    recorded; unmatched: the number of files that the pattern of paths does not match. Raises
    LeaseLost.
    """
    parked = leases.park(tx, lease, detail)
    payload = job_repository.get_row(tx, parked.id)["payload"]
    total, waiting = _counts(tx, parked.id)
    _update(
        tx,
        parked.id,
        payload={**payload, _ABSENT_COUNT: absent, _UNMATCHED: unmatched, _FILES: total},
        progress=(total - waiting) / max(total, 1),
    )
    return settle_if_done(tx, parked.id, ended=0)


def waiting_on(tx: Tx, clip_ids: Collection[str]) -> dict[str, int]:
    """The open import jobs that wait for any of these clips, each with the number of them."""
    if not clip_ids:
        return {}
    query = (
        select(jobs.c.id, func.count())
        .join(import_entries, import_entries.c.job_id == jobs.c.id)
        .where(
            import_entries.c.clip_id.in_(clip_ids),
            jobs.c.state == JobState.PROCESSING.value,
        )
        .group_by(jobs.c.id)
    )
    return {job_id: int(number) for job_id, number in tx.execute(query)}


def settle_if_done(tx: Tx, job_id: str, ended: int) -> JobRecord:
    """Ends an unpacked import if all its clips have ended; otherwise updates its progress.

    ended: the number of its clips that have ended since the last call. Raises JobNotFound.
    """
    # If the last two clips end in transactions at the same time, each would see the other clip as
    # unfinished, and nobody would end the import.
    library.lock(tx)
    row = job_repository.get_row(tx, job_id)
    if row["state"] != JobState.PROCESSING.value or row["owner"] is not None:
        return job_repository.to_record(row)
    if tx.execute(_ANY_UNFINISHED, {"the_id": job_id}).first() is not None:
        # Not a new count: for a hundred thousand files it takes longer than an analysis.
        total = row["payload"].get(_FILES) or _counts(tx, job_id)[0]
        return _update(tx, job_id, progress=min(row["progress"] + ended / total, 1.0))
    done = _update(
        tx,
        job_id,
        state=JobState.SUCCEEDED.value,
        progress=1.0,
        detail=None,
        finished_at=utc_now(),
        result=_result(tx, job_id, row["payload"]),
    )
    endings.announce(tx, [job_repository.get_row(tx, job_id)])
    return done


def _result(tx: Tx, job_id: str, payload: Mapping[str, Any]) -> dict[str, Any]:
    # Only counts, without the files: an import may hold a hundred thousand of them.
    number_of = import_files.count(tx, job_id)
    counts = {name: number_of.get(outcome, 0) for name, outcome in COUNTED.items()}
    counts["absent"] = payload.get(_ABSENT_COUNT) or counts["absent"]
    return {
        "total": sum(counts.values()),
        **counts,
        _UNMATCHED: payload.get(_UNMATCHED, 0),
        "warnings": import_files.count_warnings(tx, job_id),
    }


def _counts(tx: Tx, job_id: str) -> tuple[int, int]:
    """The number of files, and the number of those whose clip has not ended yet."""
    unfinished = func.count().filter(
        or_(clips.c.state.in_(_UNFINISHED), clips.c.reanalysis.in_(REANALYSIS_OPEN))
    )
    query = (
        select(func.count(), unfinished)
        .select_from(import_entries)
        .outerjoin(clips, clips.c.id == import_entries.c.clip_id)
        .where(import_entries.c.job_id == job_id)
    )
    total, waiting = tx.execute(query).one()
    return int(total), int(waiting)


def _update(tx: Tx, job_id: str, **values: Any) -> JobRecord:
    changed = update(jobs).where(jobs.c.id == job_id).values(**values).returning(jobs)
    return job_repository.to_record(tx.execute(changed).mappings().one())
