"""Files that are to be removed, recorded by the transaction that made them unneeded.

A file is removed after that transaction is committed; were it removed before, an undone
transaction would have lost it. The record is what makes the removal certain: after a crash, a
sweep finishes it. A file without such a record is never removed, but set aside (`quarantine`).
"""

from __future__ import annotations

import logging
from collections.abc import Collection

from sqlalchemy import and_, delete, exists, insert, or_, select, update

from app.errors import StorageError
from app.store.database.engine import Tx
from app.store.database.tables import file_removals, jobs
from app.store.files.files import FileStore
from app.store.jobs import references
from app.store.jobs.record import JobState

_log = logging.getLogger(__name__)

# An import that is unpacked waits for its clips, without an owner, and needs its archive no more.
_NEEDS_ITS_FILE = or_(
    jobs.c.state == JobState.QUEUED.value,
    and_(jobs.c.state == JobState.PROCESSING.value, jobs.c.owner.is_not(None)),
)
# `> ""` rather than "is not null": that SQLite finds by the index.
_IS_DONE_WITH_ITS_FILE = and_(jobs.c.file_sha256 > "", ~_NEEDS_ITS_FILE)

# Made once: every write transaction ends with the first.
_IS_ANY = select(
    exists().where(file_removals.c.sha256 > ""), exists().where(_IS_DONE_WITH_ITS_FILE)
)
_FILES_OF_ENDED = select(jobs.c.file_sha256).where(_IS_DONE_WITH_ITS_FILE).distinct()
_LET_GO = update(jobs).where(_IS_DONE_WITH_ITS_FILE).values(file_sha256=None)


def record(tx: Tx, sha256s: Collection[str | None]) -> None:
    """Records those of the files that nothing refers to any more; None is passed over."""
    named = [sha256 for sha256 in sha256s if sha256 is not None]
    unneeded = references.unreferenced(tx, named)
    known = set(tx.execute(select(file_removals.c.sha256)).scalars())
    rows = [{"sha256": sha256} for sha256 in unneeded if sha256 not in known]
    if rows:
        tx.execute(insert(file_removals), rows)


def settle(tx: Tx) -> bool:
    """Records the archives of imports that need them no more; whether anything is to be removed.

    Each write transaction ends with it, so that no way to end an import can forget its archive.
    """
    is_recorded, is_ended = tx.execute(_IS_ANY).one()
    if is_ended:
        archives = list(tx.execute(_FILES_OF_ENDED).scalars())
        tx.execute(_LET_GO)
        record(tx, archives)
    return bool(is_recorded or is_ended)


def forget_all(tx: Tx) -> None:
    """Takes back all records, where the files are not: in a copy of the database."""
    tx.execute(delete(file_removals))


def finish(tx: Tx, files: FileStore) -> int:
    """Removes the recorded files, and their records; how many files.

    Within a write transaction, so that no one stores the same bytes meanwhile. What has come to
    be needed again stays.
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
