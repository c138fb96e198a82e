"""Imports: what became of each file of an archive, and when the import as a whole is done.

An import job unpacks; each clip that it adds has an ingest job of its own. The import is done
when the last of its clips is.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from sqlalchemy import RowMapping, func, insert, or_, select, update

from app.store import jobs as job_repository
from app.store import leases, library
from app.store.clip_record import REANALYSIS_OPEN, ClipState
from app.store.engine import Tx
from app.store.ids import utc_now
from app.store.job_record import JobRecord, JobState, Lease
from app.store.tables import clips, import_entries, jobs


class ImportOutcome(StrEnum):
    """What became of one file when the archive was unpacked."""

    QUEUED = "queued"
    """Stored as a clip that waits for its analysis (or waited, or failed and waits again)."""
    EXISTS = "exists"
    """The same content was in the library."""
    FAILED = "failed"
    """Not stored; `problem` says why."""


@dataclass(frozen=True, slots=True)
class ImportEntry:
    """One file of an import. clip_state: None when there is no clip (any more)."""

    path: str
    outcome: ImportOutcome
    clip_id: str | None
    problem: dict[str, Any] | None
    clip_state: ClipState | None
    clip_error: dict[str, Any] | None


_UNFINISHED = (ClipState.QUEUED.value, ClipState.PROCESSING.value)
_ADD_ENTRY = insert(import_entries)


def add_entry(
    tx: Tx,
    job_id: str,
    path: str,
    outcome: ImportOutcome,
    *,
    clip_id: str | None = None,
    problem: dict[str, Any] | None = None,
) -> None:
    """Records a file, in the transaction that stores its clip; each path once."""
    values = {
        "job_id": job_id,
        "path": path,
        "outcome": outcome.value,
        "clip_id": clip_id,
        "problem": problem,
    }
    tx.execute(_ADD_ENTRY, values)


def recorded_paths(tx: Tx, job_id: str) -> frozenset[str]:
    """Files that are recorded already: an import that is tried again passes them over."""
    query = select(import_entries.c.path).where(import_entries.c.job_id == job_id)
    return frozenset(tx.execute(query).scalars())


def entries(tx: Tx, job_id: str) -> tuple[ImportEntry, ...]:
    """All files of an import, by path."""
    rows = tx.execute(
        select(import_entries, clips.c.state, clips.c.error)
        .outerjoin(clips, clips.c.id == import_entries.c.clip_id)
        .where(import_entries.c.job_id == job_id)
        .order_by(import_entries.c.path)
    )
    return tuple(_to_entry(row) for row in rows.mappings())


def wait_for_clips(tx: Tx, lease: Lease, detail: str | None = None) -> JobRecord:
    """The archive is unpacked: the job needs no worker from here on, and ends with its clips."""
    parked = leases.park(tx, lease, detail)
    return settle_if_done(tx, parked.id)


def waiting_on(tx: Tx, clip_ids: Collection[str]) -> tuple[str, ...]:
    """The open import jobs that have one of these clips among theirs."""
    if not clip_ids:
        return ()
    query = (
        select(jobs.c.id)
        .join(import_entries, import_entries.c.job_id == jobs.c.id)
        .where(
            import_entries.c.clip_id.in_(clip_ids),
            jobs.c.state == JobState.PROCESSING.value,
        )
        .distinct()
    )
    return tuple(tx.execute(query).scalars())


def settle_if_done(tx: Tx, job_id: str) -> JobRecord:
    """Ends an unpacked import whose clips are all done; else brings its progress up to date."""
    # Where writers overlap, the last two clips must not each see the other as unfinished.
    library.lock(tx)
    row = job_repository.get_row(tx, job_id)
    if row["state"] != JobState.PROCESSING.value or row["owner"] is not None:
        return job_repository.to_record(row)
    total, waiting = _counts(tx, job_id)
    if waiting:
        return _update(tx, job_id, progress=(total - waiting) / total)
    return _update(
        tx,
        job_id,
        state=JobState.SUCCEEDED.value,
        progress=1.0,
        detail=None,
        finished_at=utc_now(),
        result=summary(entries(tx, job_id)),
    )


def summary(files: tuple[ImportEntry, ...]) -> dict[str, Any]:
    """The `result` of an import: counts by outcome, and each file's outcome with its reason."""
    lines = [_line(entry) for entry in files]
    counts = Counter(line["outcome"] for line in lines)
    return {
        "total": len(lines),
        **{name: counts[name] for name in ("ready", "exists", "failed", "deleted")},
        "files": lines,
    }


def _line(entry: ImportEntry) -> dict[str, Any]:
    outcome, error = entry.outcome.value, entry.problem
    if entry.outcome is ImportOutcome.QUEUED:
        outcome = "deleted" if entry.clip_state is None else entry.clip_state.value
        error = entry.clip_error
    return {"path": entry.path, "outcome": outcome, "clip_id": entry.clip_id, "error": error}


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


def _to_entry(row: RowMapping) -> ImportEntry:
    return ImportEntry(
        path=row["path"],
        outcome=ImportOutcome(row["outcome"]),
        clip_id=row["clip_id"],
        problem=row["problem"],
        clip_state=None if row["state"] is None else ClipState(row["state"]),
        clip_error=row["error"],
    )
