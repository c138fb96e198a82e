"""Mends what can be mended in the store: indexes of the database, and files from a backup.

What cannot be mended is marked on its clip. Nothing is deleted: a damaged file stays until a whole
one replaces it, because a person may still read most of it.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path

from sqlalchemy import ColumnElement, String, cast, or_, select, update
from sqlalchemy.exc import SQLAlchemyError

from app.errors import BadField, FileDamaged, NotFound, StorageError, StoredFileMissing
from app.kinedex_error import Place
from app.store.clips import repository
from app.store.clips.record import ClipRecord, ClipState, ClipWarning
from app.store.database.engine import Tx
from app.store.database.tables import clips
from app.store.files.files import FileStore
from app.store.files.local_files import LocalFiles
from app.store.jobs import references
from app.store.store import Store
from app.store.upkeep.backup import FILES

FILE_CODES = frozenset({StoredFileMissing.code, FileDamaged.code})
"""Codes of warnings and failures of clips that say that a file is missing or damaged."""


def rebuild_indexes(store: Store) -> bool:
    """Builds the indexes of an SQLite database again; returns whether it has no damage then."""
    if store.database.file is None:
        return False
    with suppress(StorageError, SQLAlchemyError):  # the tables are damaged too
        with store.write() as tx:
            tx.exec_driver_sql("REINDEX")
        if not store.database.find_damage():
            store.database.clear_damage()
            return True
    return False


def open_backup(path: Path) -> FileStore:
    """The files of a backup, or of any data directory. Raises BadField if it has none."""
    if not (path / FILES).is_dir():
        message = f"{path} is no backup: it has no folder {FILES}"
        raise BadField(f"from: {message}", places=[Place("from", message)])
    return LocalFiles(path / FILES)


def restore_files(store: Store, names: Iterable[str], backup: FileStore) -> tuple[str, ...]:
    """Copies files from a backup if their bytes there have the right SHA-256; returns their names.

    Raises DiskFull, StorageError.
    """
    return tuple(sha256 for sha256 in names if _restore(store, sha256, backup))


def _restore(store: Store, sha256: str, backup: FileStore) -> bool:
    try:
        content = backup.open(sha256)
    except (NotFound, OSError, StorageError):
        return False
    with content, store.files.stage(content) as staged:
        if staged.sha256 != sha256:
            return False
        with store.write() as tx:
            if references.unreferenced(tx, [sha256]):
                return False  # its clip was deleted meanwhile
            staged.keep()
    return True


def clips_of_files(tx: Tx, names: Collection[str]) -> tuple[ClipRecord, ...]:
    """The clips that need one of the files."""
    ids: set[str] = set()
    for batch in repository.in_batches(names):
        columns = (clips.c.sha256, clips.c.skeleton_sha256, clips.c.audio_sha256)
        needs = or_(*(column.in_(batch) for column in columns))
        ids.update(tx.execute(select(clips.c.id).where(needs)).scalars())
    return tuple(repository.get_many(tx, sorted(ids)).values())


def clips_that_lacked_files(tx: Tx) -> tuple[ClipRecord, ...]:
    """The clips with a warning or a failure that says that a file is missing or damaged."""
    found = or_(
        *(_holds(clips.c.warnings, code) for code in FILE_CODES),
        clips.c.error["code"].as_string().in_(FILE_CODES),
    )
    ids = tx.execute(select(clips.c.id).where(found).order_by(clips.c.id)).scalars().all()
    return tuple(repository.get_many(tx, ids).values())


def _holds(column: ColumnElement[object], code: str) -> ColumnElement[bool]:
    return cast(column, String).contains(f'"{code}"', autoescape=True)


def mark(tx: Tx, clip: ClipRecord, missing: Collection[str], damaged: Collection[str]) -> bool:
    """Adds the warning that files of a ready clip are missing or damaged; False if it has it.

    Other clips need none: their analysis fails, and says why.
    """
    if clip.state is not ClipState.READY:
        return False
    warnings = [warning for warning in clip.warnings if warning.code not in FILE_CODES]
    warnings += _file_warnings(clip, missing, damaged)
    if warnings == list(clip.warnings):
        return False
    _set_warnings(tx, clip.id, warnings)
    return True


def unmark(tx: Tx, clip: ClipRecord) -> None:
    """Removes the warnings of `mark`, after the files were mended."""
    _set_warnings(tx, clip.id, [each for each in clip.warnings if each.code not in FILE_CODES])


def files_of(clip: ClipRecord) -> dict[str, str]:
    """What each file of a clip is, by its SHA-256."""
    named = {
        clip.audio_sha256: "recording",
        clip.skeleton_sha256: "skeleton file",
        clip.sha256: "motion file",
    }
    return {sha256: noun for sha256, noun in named.items() if sha256 is not None}


def _file_warnings(
    clip: ClipRecord, missing: Collection[str], damaged: Collection[str]
) -> list[ClipWarning]:
    then = (
        "Searches still find the clip, but it cannot be analyzed again. Send the same file again,"
        " or run `kinedex doctor --mend --from BACKUP`."
    )
    found = []
    for sha256, noun in files_of(clip).items():
        if sha256 in missing:
            detail = f"The stored {noun} is missing ({sha256}). {then}"
            found.append(ClipWarning(StoredFileMissing.code, detail))
        elif sha256 in damaged:
            detail = f"The stored {noun} is damaged: its bytes have changed ({sha256}). {then}"
            found.append(ClipWarning(FileDamaged.code, detail))
    return found


def _set_warnings(tx: Tx, clip_id: str, warnings: Collection[ClipWarning]) -> None:
    values = [asdict(warning) for warning in warnings]
    tx.execute(update(clips).where(clips.c.id == clip_id).values(warnings=values))
