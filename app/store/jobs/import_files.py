"""The files of an import: what became of each, counted, and page by page.

What is told of a file is read when it is asked for, from the import's entries and their clips:
a clip that was deleted later is told as deleted.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from sqlalchemy import RowMapping, Select, case, func, select

from app.store.clips.record import ClipState
from app.store.database.engine import Tx
from app.store.database.paging import Page, Position, read_cursor, write_cursor
from app.store.database.tables import clips, import_entries
from app.store.database.totals import Total, exact_total

BY_PATH = "path"


class ImportOutcome(StrEnum):
    """What became of one file when the archive was unpacked."""

    QUEUED = "queued"
    """Stored as a clip that waits for its analysis (or waited, or failed and waits again)."""
    EXISTS = "exists"
    """The same content was in the library."""
    FAILED = "failed"
    """Not stored; `problem` says why."""
    ABSENT = "absent"
    """Named by a manifest, and not there."""


class FileOutcome(StrEnum):
    """What has become of one file by now."""

    QUEUED = "queued"
    """A clip that waits for its analysis."""
    PROCESSING = "processing"
    """A clip that is being analysed."""
    READY = "ready"
    """A clip that can be searched."""
    EXISTS = "exists"
    """The library held the same content before."""
    FAILED = "failed"
    """No clip, or one that cannot be analysed."""
    DELETED = "deleted"
    """A clip that was deleted since."""
    ABSENT = "absent"
    """Named by a manifest, and not there."""


PROBLEMS = (FileOutcome.FAILED, FileOutcome.ABSENT)
"""What the owner of the files should look at."""


@dataclass(frozen=True, slots=True)
class ImportedFile:
    """One file of an import. clip_id: None without a clip; error: RFC 9457 problem."""

    path: str
    outcome: FileOutcome
    clip_id: str | None
    error: dict[str, Any] | None


_BECAME_CLIP = import_entries.c.outcome == ImportOutcome.QUEUED.value
_outcome = case(
    (~_BECAME_CLIP, import_entries.c.outcome),
    (clips.c.state.is_(None), FileOutcome.DELETED.value),
    else_=clips.c.state,
)
_FILES = (
    select(
        import_entries.c.path,
        _outcome.label("outcome"),
        import_entries.c.clip_id,
        import_entries.c.problem,
        clips.c.error,
    )
    .select_from(import_entries)
    .outerjoin(clips, clips.c.id == import_entries.c.clip_id)
    .order_by(import_entries.c.path)
)


def count(tx: Tx, job_id: str) -> dict[FileOutcome, int]:
    """How many files of an import came to what; outcomes of no file are left out."""
    query = (
        select(_outcome, func.count())
        .select_from(import_entries)
        .outerjoin(clips, clips.c.id == import_entries.c.clip_id)
        .where(import_entries.c.job_id == job_id)
        .group_by(_outcome)
    )
    return {FileOutcome(outcome): int(number) for outcome, number in tx.execute(query)}


def page(
    tx: Tx,
    job_id: str,
    *,
    outcome: FileOutcome | None = None,
    limit: int = 50,
    cursor: str | None = None,
) -> Page[ImportedFile]:
    """One page of at most `limit` files of an import, by path; raises BadField at "cursor"."""
    query = _of(job_id)
    if outcome is not None:
        query = query.where(_outcome == outcome.value)
    if cursor is not None:
        position = read_cursor(cursor, BY_PATH, str)
        query = query.where(import_entries.c.path > position.value)
    found = _read(tx, query.limit(limit + 1))
    shown = found[:limit]
    if len(found) <= limit or not shown:
        return Page(shown, None)
    return Page(shown, write_cursor(BY_PATH, Position(shown[-1].path, "")))


def total(tx: Tx, job_id: str, outcome: FileOutcome | None = None) -> Total:
    """How many files of an import `page` lists."""
    files = select(import_entries.c.path).where(import_entries.c.job_id == job_id)
    if outcome is not None:
        files = files.outerjoin(clips, clips.c.id == import_entries.c.clip_id)
        files = files.where(_outcome == outcome.value)
    return exact_total(tx, files)


def first(tx: Tx, job_id: str, most: int, *, has_problems: bool = True) -> tuple[ImportedFile, ...]:
    """The first files of an import, by path; where there are more than `most`, those that
    failed or are absent go before the others.

    `has_problems=False` saves the search for them.
    """
    found = _read(tx, _of(job_id).limit(most + 1))
    if len(found) <= most or not has_problems:
        return found[:most]
    problems = _read(
        tx, _of(job_id).where(_outcome.in_([each.value for each in PROBLEMS])).limit(most)
    )
    named = {file.path for file in problems}
    others = [file for file in found if file.path not in named]
    chosen = [*problems, *others[: most - len(problems)]]
    return tuple(sorted(chosen, key=lambda file: file.path))


def _of(job_id: str) -> Select[Any]:
    return _FILES.where(import_entries.c.job_id == job_id)


def _read(tx: Tx, query: Select[Any]) -> tuple[ImportedFile, ...]:
    return tuple(_to_file(row) for row in tx.execute(query).mappings())


def _to_file(row: RowMapping) -> ImportedFile:
    return ImportedFile(
        path=row["path"],
        outcome=FileOutcome(row["outcome"]),
        clip_id=row["clip_id"],
        error=row["problem"] or _clip_error(row),
    )


def _clip_error(row: RowMapping) -> dict[str, Any] | None:
    """Of a clip that failed; one that existed before is not the import's to explain."""
    error: dict[str, Any] | None = row["error"]
    return error if row["outcome"] == ClipState.FAILED.value else None
