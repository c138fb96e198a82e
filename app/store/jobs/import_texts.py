"""The texts of jobs that may name a person.

These are paths and names of imported files, labels, problems, and the filters of evaluations.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from sqlalchemy import bindparam, select, update

from app.store.database.engine import Tx
from app.store.database.tables import import_entries, jobs
from app.store.jobs.record import JobKind

Rewrite = Callable[[str | None, Any], Any]
"""Gets the id of a file's clip, None without a clip, and JSON; returns the JSON to store."""

_ENTRIES = select(
    import_entries.c.job_id,
    import_entries.c.path,
    import_entries.c.clip_id,
    import_entries.c.problem,
    import_entries.c.differences,
)
_CHANGE_ENTRY = update(import_entries).where(
    import_entries.c.job_id == bindparam("the_job"), import_entries.c.path == bindparam("the_path")
)
_JOBS = select(jobs.c.id, jobs.c.payload, jobs.c.detail, jobs.c.error).where(
    jobs.c.kind.in_([JobKind.IMPORT.value, JobKind.EVALUATE.value])
)
_CHANGE_JOB = update(jobs).where(jobs.c.id == bindparam("the_id"))


def rewrite(tx: Tx, new: Rewrite) -> None:
    """Replace the texts of all imports and of their files, and those of all evaluations."""
    for job in tx.execute(_JOBS).all():
        before = {"payload": job.payload, "detail": job.detail, "error": job.error}
        now = new(None, before)
        if now != before:
            tx.execute(_CHANGE_JOB, {"the_id": job.id, **now})
    entries = tx.execute(_ENTRIES).all()
    taken = {(entry.job_id, entry.path) for entry in entries}
    for entry in entries:
        before = {
            "path": entry.path,
            "problem": entry.problem,
            "differences": entry.differences,
        }
        now = new(entry.clip_id, before)
        if now == before:
            continue
        if now["path"] != entry.path:
            now["path"] = _free_path(taken, entry.job_id, now["path"])
        tx.execute(_CHANGE_ENTRY, {"the_job": entry.job_id, "the_path": entry.path, **now})


def _free_path(taken: set[tuple[str, str]], job_id: str, path: str) -> str:
    """The path, with a number if another file of the import has it."""
    free, number = path, 1
    while (job_id, free) in taken:
        number += 1
        free = f"{path} ({number})"
    taken.add((job_id, free))
    return free
