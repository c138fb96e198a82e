"""Imports: recording what became of each file, and when the import as a whole is done.

An import job unpacks; each clip that it adds has an ingest job of its own. The import is done
when the last of its clips is. Its files are read in `import_files`.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

from sqlalchemy import bindparam, exists, func, insert, or_, select, update

from app.store.clips import versions as library
from app.store.clips.record import REANALYSIS_OPEN, ClipState
from app.store.database.engine import Tx
from app.store.database.ids import utc_now
from app.store.database.tables import clips, import_entries, jobs
from app.store.jobs import endings, import_files, leases
from app.store.jobs import repository as job_repository
from app.store.jobs.import_files import FileOutcome, ImportOutcome
from app.store.jobs.record import JobRecord, JobState, Lease

COUNTED = (
    FileOutcome.READY,
    FileOutcome.EXISTS,
    FileOutcome.FAILED,
    FileOutcome.DELETED,
    FileOutcome.ABSENT,
)
"""The outcomes of an import that has ended, as its result counts them."""
_ABSENT_COUNT = "absent"
"""Member of an import's payload: how many paths its manifests name in vain."""
_FILES = "files"
"""Member of the payload: how many files are recorded."""
_UNFINISHED = (ClipState.QUEUED.value, ClipState.PROCESSING.value)
_ADD_ENTRIES = insert(import_entries)
# From the clips that wait, of which there are few towards the end, not from all files.
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
    """What became of a file: a clip, or a problem (as RFC 9457 has it)."""

    path: str
    outcome: ImportOutcome
    clip_id: str | None = None
    problem: dict[str, Any] | None = None


def add_entries(tx: Tx, job_id: str, new: Sequence[NewEntry]) -> None:
    """Records files, a clip's in the transaction that stores it; each path once."""
    if new:
        rows = [
            {
                "job_id": job_id,
                "path": entry.path,
                "outcome": entry.outcome.value,
                "clip_id": entry.clip_id,
                "problem": entry.problem,
            }
            for entry in new
        ]
        tx.execute(_ADD_ENTRIES, rows)


def recorded_paths(tx: Tx, job_id: str) -> frozenset[str]:
    """Files that are recorded already: an import that goes on passes them over."""
    query = select(import_entries.c.path).where(import_entries.c.job_id == job_id)
    return frozenset(tx.execute(query).scalars())


def waiting_clips(tx: Tx, job_id: str) -> tuple[str, ...]:
    """The clips of an import that wait for their analysis, or are being analysed."""
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


def give_turn(tx: Tx, lease: Lease, progress: float, detail: str, lowest: int) -> JobRecord:
    """Back into the queue behind other imports, one step less urgent, but not below `lowest`.

    No attempt is counted, and the progress stays. Raises LeaseLost.
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
    tx: Tx, lease: Lease, detail: str | None = None, *, absent: int = 0
) -> JobRecord:
    """The archive is unpacked: the job needs no worker from here on, and ends with its clips.

    absent: how many paths the manifests name in vain, recorded or not. Raises LeaseLost.
    """
    parked = leases.park(tx, lease, detail)
    payload = job_repository.get_row(tx, parked.id)["payload"]
    total, waiting = _counts(tx, parked.id)
    _update(
        tx,
        parked.id,
        payload={**payload, _ABSENT_COUNT: absent, _FILES: total},
        progress=(total - waiting) / max(total, 1),
    )
    return settle_if_done(tx, parked.id, ended=0)


def waiting_on(tx: Tx, clip_ids: Collection[str]) -> dict[str, int]:
    """The open import jobs that have some of these clips among theirs, with how many."""
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
    """Ends an unpacked import whose clips are all done; else brings its progress up to date.

    ended: how many of its clips have come to their end since the last call.
    """
    # Where writers overlap, the last two clips must not each see the other as unfinished.
    library.lock(tx)
    row = job_repository.get_row(tx, job_id)
    if row["state"] != JobState.PROCESSING.value or row["owner"] is not None:
        return job_repository.to_record(row)
    if tx.execute(_ANY_UNFINISHED, {"the_id": job_id}).first() is not None:
        # Not counted anew: of a hundred thousand files that takes longer than an analysis.
        total = row["payload"].get(_FILES) or _counts(tx, job_id)[0]
        return _update(tx, job_id, progress=min(row["progress"] + ended / total, 1.0))
    done = _update(
        tx,
        job_id,
        state=JobState.SUCCEEDED.value,
        progress=1.0,
        detail=None,
        finished_at=utc_now(),
        result=_result(tx, job_id, row["payload"].get(_ABSENT_COUNT)),
    )
    endings.announce(tx, [job_repository.get_row(tx, job_id)])
    return done


def _result(tx: Tx, job_id: str, absent: int | None) -> dict[str, Any]:
    """Counts only: an import may hold a hundred thousand files."""
    found = import_files.count(tx, job_id)
    counts = {outcome.value: found.get(outcome, 0) for outcome in COUNTED}
    counts[FileOutcome.ABSENT.value] = absent or counts[FileOutcome.ABSENT.value]
    return {"total": sum(counts.values()), **counts}


def _counts(tx: Tx, job_id: str) -> tuple[int, int]:
    """How many files, and how many of them have a clip that is still to end."""
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
