"""The files of an import with their outcomes: their counts, and pages of them.

The outcome of a file is computed at each call, from the entries of the import and the current
clips. So a clip that was deleted later has the outcome `deleted`.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from sqlalchemy import RowMapping, Select, String, case, cast, func, select

from app.store.clips.record import ClipState
from app.store.database.engine import Tx
from app.store.database.paging import Page, Position, read_cursor, write_cursor
from app.store.database.tables import clips, import_entries
from app.store.database.totals import Total, exact_total

BY_PATH = "path"


class ImportOutcome(StrEnum):
    """The outcome of one file when the archive was unpacked; it does not change later."""

    QUEUED = "queued"
    """The file was stored as a clip, which was queued for its analysis."""
    UPDATED = "updated"
    """The library already had the same content; labels that came with the file were applied."""
    UNCHANGED = "unchanged"
    """The library already had the same content with the same labels."""
    CONFLICTING = "conflicting"
    """The library already had the same content; a label that came with the file was not applied."""
    FAILED = "failed"
    """The file was not stored; `problem` says why."""
    SKIPPED = "skipped"
    """The file is not a motion; `problem` says why."""
    ABSENT = "absent"
    """A manifest names the file, but the archive does not contain it."""


class FileOutcome(StrEnum):
    """The current outcome of one file."""

    QUEUED = "queued"
    """Its clip waits for an analysis."""
    PROCESSING = "processing"
    """Its clip is being analyzed."""
    READY = "ready"
    """Its clip can be searched."""
    UPDATED = "updated"
    """The library had the same content before the import; other labels that came were applied."""
    UNCHANGED = "unchanged"
    """The library had the same content, with the same labels, before the import."""
    CONFLICTING = "conflicting"
    """The library had the same content before the import; a label that came differs from the
    stored one, and was not applied because somebody edited the stored one."""
    FAILED = "failed"
    """It did not become a clip, or its clip cannot be analyzed."""
    SKIPPED = "skipped"
    """It is not a motion."""
    DELETED = "deleted"
    """Its clip was deleted later."""
    ABSENT = "absent"
    """A manifest names the file, but the archive does not contain it."""


PROBLEMS = (FileOutcome.FAILED, FileOutcome.ABSENT, FileOutcome.CONFLICTING)
"""Outcomes that the owner of the files should look at."""


@dataclass(frozen=True, slots=True)
class ImportedFile:
    """One file of an import.

    clip_id: None without a clip; error: an RFC 9457 problem; differences: from the stored clip (see
    `Difference`); warnings: of its clip now (see `ClipWarning`).
    """

    path: str
    outcome: FileOutcome
    clip_id: str | None
    error: dict[str, Any] | None
    differences: tuple[dict[str, Any], ...] = ()
    warnings: tuple[dict[str, Any], ...] = ()


_BECAME_CLIP = import_entries.c.outcome == ImportOutcome.QUEUED.value
_outcome = case(
    (~_BECAME_CLIP, import_entries.c.outcome),
    (clips.c.state.is_(None), FileOutcome.DELETED.value),
    else_=clips.c.state,
)
# Most clips have no warning ("[]"); their JSON need not be read.
_WARNINGS = cast(clips.c.warnings, String)
_FILES = (
    select(
        import_entries.c.path,
        _outcome.label("outcome"),
        import_entries.c.clip_id,
        import_entries.c.problem,
        import_entries.c.differences,
        clips.c.error,
        clips.c.warnings,
    )
    .select_from(import_entries)
    .outerjoin(clips, clips.c.id == import_entries.c.clip_id)
    .order_by(import_entries.c.path)
)


def count(tx: Tx, job_id: str) -> dict[FileOutcome, int]:
    """The number of files of an import by outcome; outcomes without files are left out."""
    query = (
        select(_outcome, func.count())
        .select_from(import_entries)
        .outerjoin(clips, clips.c.id == import_entries.c.clip_id)
        .where(import_entries.c.job_id == job_id)
        .group_by(_outcome)
    )
    return {FileOutcome(outcome): int(number) for outcome, number in tx.execute(query)}


def count_warnings(tx: Tx, job_id: str) -> dict[str, int]:
    """The number of clips of an import by the code of each warning that they have."""
    query = (
        select(clips.c.id, clips.c.warnings)
        .join(import_entries, import_entries.c.clip_id == clips.c.id)
        .where(import_entries.c.job_id == job_id, _WARNINGS.not_in(("[]", "null")))
    )
    of_clip = {clip_id: warnings or () for clip_id, warnings in tx.execute(query)}
    counts: Counter[str] = Counter()
    for warnings in of_clip.values():
        counts.update({warning["code"] for warning in warnings})
    return dict(sorted(counts.items()))


def page(
    tx: Tx,
    job_id: str,
    *,
    outcome: FileOutcome | None = None,
    limit: int = 50,
    cursor: str | None = None,
) -> Page[ImportedFile]:
    """At most `limit` files of an import, sorted by path; raises PageNotFound at "cursor"."""
    query = _of(job_id)
    if outcome is not None:
        query = query.where(_outcome == outcome.value)
    if cursor is not None:
        position = read_cursor(cursor, BY_PATH, str)
        query = query.where(import_entries.c.path > position.value)
    files = _read(tx, query.limit(limit + 1))  # one more, to know whether there is another page
    shown = files[:limit]
    if len(files) <= limit or not shown:
        return Page(shown, None)
    return Page(shown, write_cursor(BY_PATH, Position(shown[-1].path, "")))


def total(tx: Tx, job_id: str, outcome: FileOutcome | None = None) -> Total:
    """How many files of an import `page` lists."""
    files = select(import_entries.c.path).where(import_entries.c.job_id == job_id)
    if outcome is not None:
        files = files.outerjoin(clips, clips.c.id == import_entries.c.clip_id)
        files = files.where(_outcome == outcome.value)
    return exact_total(tx, files)


def first(
    tx: Tx, job_id: str, limit: int, *, has_problems: bool = True
) -> tuple[ImportedFile, ...]:
    """At most `limit` files of an import, sorted by path.

    If there are more files, those with an outcome in PROBLEMS are chosen first. A caller that
    knows that there are none passes `has_problems=False`, which saves a query.
    """
    files = _read(tx, _of(job_id).limit(limit + 1))
    if len(files) <= limit or not has_problems:
        return files[:limit]
    problems = _read(
        tx, _of(job_id).where(_outcome.in_([each.value for each in PROBLEMS])).limit(limit)
    )
    problem_paths = {file.path for file in problems}
    others = [file for file in files if file.path not in problem_paths]
    chosen = [*problems, *others[: limit - len(problems)]]
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
        differences=tuple(row["differences"] or ()),
        warnings=tuple(row["warnings"] or ()),
    )


def _clip_error(row: RowMapping) -> dict[str, Any] | None:
    """The error of a clip that this import added; clips that existed before have none here."""
    error: dict[str, Any] | None = row["error"]
    return error if row["outcome"] == ClipState.FAILED.value else None
