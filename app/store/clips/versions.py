"""The library version: one number that grows with every change that a search can see.

The transaction of a change raises it. The update locks the only row of the table until the commit,
so versions become visible in their order on any database: an index that has read all changes up to
version v has missed none of them.
"""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import insert, select, update

from app.store.clips.record import ClipState
from app.store.database import schema, signals
from app.store.database.engine import Tx
from app.store.database.signals import Signal
from app.store.database.tables import clips, library, tombstones

ONLY_ROW = 1

# Built once, because every step of an ingest executes them.
_VERSION = select(library.c.version).where(library.c.id == ONLY_ROW)
_LIBRARY_ID = select(library.c.library_id).where(library.c.id == ONLY_ROW)
_VERSION_TO_CHANGE = _VERSION.with_for_update()
_RAISE = (
    update(library)
    .where(library.c.id == ONLY_ROW)
    .values(version=library.c.version + 1)
    .returning(library.c.version)
)


@dataclass(frozen=True, slots=True)
class LibraryChanges:
    """The changes that bring an index to `version`.

    changed: ids of ready clips, which the index loads again; removed: ids of clips that are
    deleted or no longer ready, which the index removes.
    """

    version: int
    changed: tuple[str, ...]
    removed: tuple[str, ...]


def version(tx: Tx) -> int:
    """The library's version; one cheap query."""
    return int(tx.execute(_VERSION).scalar_one())


def library_id(tx: Tx) -> str:
    """The id of the library, made when the library was created."""
    return str(tx.execute(_LIBRARY_ID).scalar_one())


def library_id_if_any(tx: Tx) -> str | None:
    """As `library_id`; None if the database has an older schema, which has no id."""
    return library_id(tx) if schema.has_column(tx, library.c.library_id) else None


def lock(tx: Tx) -> None:
    """Makes other transactions that call `lock` or `bump` wait until this one ends."""
    tx.execute(_VERSION_TO_CHANGE)


def bump(tx: Tx) -> int:
    """Raises the version and returns the new one."""
    signals.send(tx, Signal.LIBRARY)
    return int(tx.execute(_RAISE).scalar_one())


def record_deletion(tx: Tx, clip_id: str) -> None:
    """Records the deletion of a clip, so that indexes remove it."""
    tx.execute(insert(tombstones).values(clip_id=clip_id, version=bump(tx)))


def changed_since(tx: Tx, since: int) -> LibraryChanges:
    """The changes after version `since`, oldest first; 0 gives the whole library."""
    now = version(tx)
    if now == since:
        return LibraryChanges(now, (), ())
    rows = tx.execute(
        select(clips.c.id, clips.c.state)
        .where(clips.c.changed_version > since)
        .order_by(clips.c.changed_version, clips.c.id)
    ).all()
    return LibraryChanges(
        version=now,
        changed=tuple(row.id for row in rows if row.state == ClipState.READY),
        removed=(
            *(row.id for row in rows if row.state != ClipState.READY),
            *deleted_since(tx, since),
        ),
    )


def deleted_since(tx: Tx, since: int) -> tuple[str, ...]:
    """Ids of the clips that were deleted after version `since`."""
    return tuple(
        tx.execute(
            select(tombstones.c.clip_id)
            .where(tombstones.c.version > since)
            .order_by(tombstones.c.version)
        ).scalars()
    )
