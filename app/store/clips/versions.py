"""The library version: one number that grows with every change that a search can see.

It is raised in the transaction of the change itself. The update locks its only row until the
commit, so versions become visible in their order, on any database: whoever has caught up to
version v has missed nothing up to v.
"""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import insert, select, update

from app.store.clips.record import ClipState
from app.store.database.engine import Tx
from app.store.database.tables import clips, library, tombstones

ONLY_ROW = 1

# Made once: every step of every ingest asks these.
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
    """What an index must change to be at `version`.

    changed: ids of clips that are ready, to be loaded again; removed: ids to forget (deleted, or
    failed after a change).
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


def lock(tx: Tx) -> None:
    """Lets no other transaction that locks or bumps go on until this one ends."""
    tx.execute(_VERSION_TO_CHANGE)


def bump(tx: Tx) -> int:
    """Raises the version and returns the new one."""
    return int(tx.execute(_RAISE).scalar_one())


def record_deletion(tx: Tx, clip_id: str) -> None:
    """Records that a clip that searches may know was deleted."""
    tx.execute(insert(tombstones).values(clip_id=clip_id, version=bump(tx)))


def changed_since(tx: Tx, since: int) -> LibraryChanges:
    """What changed after version `since`; 0 gives the whole library, oldest change first."""
    now = version(tx)
    if now == since:
        return LibraryChanges(now, (), ())
    touched = tx.execute(
        select(clips.c.id, clips.c.state)
        .where(clips.c.changed_version > since)
        .order_by(clips.c.changed_version, clips.c.id)
    ).all()
    return LibraryChanges(
        version=now,
        changed=tuple(row.id for row in touched if row.state == ClipState.READY),
        removed=(
            *(row.id for row in touched if row.state != ClipState.READY),
            *deleted_since(tx, since),
        ),
    )


def deleted_since(tx: Tx, since: int) -> tuple[str, ...]:
    """Ids of the clips that searches may know from version `since` and that were deleted."""
    return tuple(
        tx.execute(
            select(tombstones.c.clip_id)
            .where(tombstones.c.version > since)
            .order_by(tombstones.c.version)
        ).scalars()
    )
