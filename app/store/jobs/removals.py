"""Removals of files, which the transaction that deletes the last reference to a file records.

The file itself is removed after the commit. If it were removed before, a rollback could not bring
it back. Because of the record a removal is never forgotten: after a crash, a sweep finishes it. A
file without a record is never removed, but moved to the quarantine.
"""

from __future__ import annotations

import logging
from collections.abc import Collection

from sqlalchemy import and_, delete, exists, insert, or_, select, update

from app.errors import StorageError
from app.store.database import schema
from app.store.database.engine import Tx
from app.store.database.tables import file_removals, jobs
from app.store.files.files import FileStore
from app.store.jobs import references
from app.store.jobs.record import JobState

_log = logging.getLogger(__name__)

# An unpacked import waits for its clips without an owner, and does not need its archive any more.
_NEEDS_ITS_FILE = or_(
    jobs.c.state == JobState.QUEUED.value,
    and_(jobs.c.state == JobState.PROCESSING.value, jobs.c.owner.is_not(None)),
)
# `> ""` instead of "is not null", because SQLite uses the index for it.
_IS_DONE_WITH_ITS_FILE = and_(jobs.c.file_sha256 > "", ~_NEEDS_ITS_FILE)

# Built once, because every write transaction executes the first of them.
_IS_ANY = select(
    exists().where(file_removals.c.sha256 > ""), exists().where(_IS_DONE_WITH_ITS_FILE)
)
_FILES_OF_ENDED = select(jobs.c.file_sha256).where(_IS_DONE_WITH_ITS_FILE).distinct()
_LET_GO = update(jobs).where(_IS_DONE_WITH_ITS_FILE).values(file_sha256=None)


def record(tx: Tx, sha256s: Collection[str | None]) -> None:
    """Records the removal of the files that nothing refers to any more; None is skipped."""
    candidates = [sha256 for sha256 in sha256s if sha256 is not None]
    unneeded = references.unreferenced(tx, candidates)
    recorded = set(tx.execute(select(file_removals.c.sha256)).scalars())
    rows = [{"sha256": sha256} for sha256 in unneeded if sha256 not in recorded]
    if rows:
        tx.execute(insert(file_removals), rows)


def settle(tx: Tx) -> bool:
    """Records the archives that no import needs any more; returns whether any file is recorded.

    Every write transaction ends with this call, so that each way to end an import removes its
    archive.
    """
    is_recorded, is_ended = tx.execute(_IS_ANY).one()
    if is_ended:
        archives = list(tx.execute(_FILES_OF_ENDED).scalars())
        tx.execute(_LET_GO)
        record(tx, archives)
    return bool(is_recorded or is_ended)


def forget_all(tx: Tx) -> None:
    """Deletes all records, in a copy of the database: their files are not in the copy.

    The copy may have an older schema, without records.
    """
    if schema.has_column(tx, file_removals.c.sha256):
        tx.execute(delete(file_removals))


def finish(tx: Tx, files: FileStore) -> int:
    """Removes the recorded files and their records; returns the number of removed files.

    It needs a write transaction, so that nobody stores the same bytes meanwhile. A file that a
    clip refers to again is not removed.
    """
    recorded = list(tx.execute(select(file_removals.c.sha256)).scalars())
    unneeded = set(references.unreferenced(tx, recorded))
    removed = 0
    for sha256 in recorded:
        if sha256 in unneeded:
            try:
                files.remove(sha256)
            except StorageError as problem:
                _log.error("the file %s cannot be removed yet: %s", sha256, problem.detail)
                continue
            removed += 1
        tx.execute(delete(file_removals).where(file_removals.c.sha256 == sha256))
    return removed
