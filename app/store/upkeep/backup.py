"""Copies a whole library, its database and its files, while it is in use.

A copy is a normal data directory: Kinedex can run on it. The database is copied as one snapshot.
Files never change, because their names are the hashes of their content, so they are copied after
the snapshot. No file is removed until then (`RemovalHold`): a clip may be deleted meanwhile, and
its file goes when the copy is complete.

The copy of a PostgreSQL database is a dump (`dump`) beside the files; `kinedex db restore` loads it
into an empty database.

The database may have the schema of an earlier version: a copy is made before each upgrade. Then the
copy has this schema too, and is upgraded as the library is.

A damaged copy is worse than none. So all pages of the copied database are checked, and the bytes
of each file are compared with its name.
"""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import BinaryIO

from app.errors import BadField, DatabaseDamaged, DiskFull, FileDamaged, NotFound, StorageError
from app.kinedex_error import Place
from app.store.clips import versions as library
from app.store.database.engine import Database
from app.store.files.files import FileStore
from app.store.files.hash_check import refuse_damage
from app.store.files.local_files import LocalFiles
from app.store.files.locked_file import locked_folder, remove_if_abandoned
from app.store.files.staging import NO_SPACE
from app.store.folders import make_private_synced, sync_folder
from app.store.jobs import references, removals
from app.store.store import Store
from app.store.upkeep import dump
from app.store.upkeep.dump import DUMP

DATABASE, FILES = "kinedex.sqlite3", "files"
"""Names in a data directory."""

PART = ".part"
"""Suffix of the folder of an unfinished copy."""

Progress = Callable[[int, int], None]
"""Called with the number of copied files and the number of all files."""


@dataclass(frozen=True, slots=True)
class Backup:
    """A finished copy. files: their number; bytes: total size of the database and the files."""

    path: Path
    files: int
    bytes: int


@dataclass(slots=True)
class _Files:
    """The files of a library and of its copy, and the names of those that cannot be copied."""

    source: FileStore
    target: FileStore
    missing: set[str] = field(default_factory=set)
    damaged: set[str] = field(default_factory=set)


def back_up(store: Store, path: Path, progress: Progress | None = None) -> Backup:
    """Copies the library to `path`, which appears only when the copy is complete and on disk.

    Raises BadField if `path` exists or nothing can be written there; ConfigurationError if the
    programs that dump a PostgreSQL database are not installed; DiskFull; DatabaseDamaged;
    StorageError, which names each missing or damaged file of the library. Then no part of the copy
    is left. If the process is killed, the next copy in the same folder removes the unfinished one.
    """
    if not store.database.is_sqlite:
        dump.check_programs()
    if os.path.lexists(path):
        message = f"{path} is there already: a copy never replaces anything"
        raise BadField(f"path: {message}", places=[Place("path", message)])
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        _remove_abandoned(path.parent)
        with locked_folder(partial(_make_part, path)) as part:
            return _copy_and_rename(store, part, path, progress)
    except OSError as problem:
        message = f"nothing can be written to {path.parent}: {problem.strerror}"
        raise BadField(f"path: {message}", places=[Place("path", message)]) from problem


def _make_part(path: Path) -> Path:
    return Path(tempfile.mkdtemp(prefix=f".{path.name}.", suffix=PART, dir=path.parent))


def _remove_abandoned(folder: Path) -> None:
    """Removes unfinished copies of dead processes: hidden folders with the content of a copy."""
    for part in folder.glob(f".*{PART}"):
        if _is_unfinished_copy(part):
            remove_if_abandoned(part, partial(shutil.rmtree, ignore_errors=True))


def _is_unfinished_copy(part: Path) -> bool:
    try:
        names = {each.name.partition("-")[0] for each in part.iterdir()}  # without "-wal"
    except OSError:
        return False
    return names <= {DATABASE, DUMP, FILES}


def _copy_and_rename(store: Store, part: Path, path: Path, progress: Progress | None) -> Backup:
    try:
        copied = _copy(store, part, progress)
        for folder in (part, part / FILES):
            sync_folder(folder)
        part.rename(path)
        sync_folder(path.parent)
    except OSError as problem:
        if problem.errno in NO_SPACE:
            raise DiskFull() from problem
        raise StorageError(f"The copy cannot be written: {problem.strerror}") from problem
    finally:
        shutil.rmtree(part, ignore_errors=True)
    return Backup(path, len(copied), _size_of(path))


def _copy(store: Store, part: Path, progress: Progress | None) -> frozenset[str]:
    """Copies database and files into the folder `part`; returns the names of the files."""
    with store.read() as tx:
        library_id = library.library_id_if_any(tx)
    make_private_synced(part / FILES)
    files = _Files(store.files, LocalFiles(part / FILES))
    if library_id is not None:
        files.target.write_id(library_id)
    with store.files.removal_hold.held():
        needed = _copy_database(store.database, part)
        _add(files, needed, progress)
    if files.missing or files.damaged:
        raise _incomplete(files)
    return needed


def _copy_database(database: Database, part: Path) -> frozenset[str]:
    """Copies the database as it is now; returns the names of the files that it needs."""
    if database.is_sqlite:
        return _copy_sqlite(database, part / DATABASE)
    with dump.snapshot(database) as taken:
        taken.dump(part / DUMP)
        return taken.needed


def _incomplete(files: _Files) -> StorageError:
    places = [Place(name, "is missing") for name in sorted(files.missing)]
    places += [Place(name, "is damaged") for name in sorted(files.damaged)]
    return StorageError(
        f"Of the files that the library refers to, {len(files.missing)} are missing and "
        f"{len(files.damaged)} are damaged; nothing was copied.",
        places=places,
    )


def _copy_sqlite(database: Database, path: Path) -> frozenset[str]:
    """As `_copy_database`, into a file.

    Raises DatabaseDamaged, because the copy has the same pages as the original, and its damage.
    """
    database.copy_to(path)
    copy = Database.at(path)
    try:
        damage = copy.find_damage()
        if damage:
            raise DatabaseDamaged(
                "The database is damaged; nothing was copied.",
                places=[Place("database", finding) for finding in damage],
            )
        with copy.write() as tx:
            # The copy has no files to remove, and a file that is stored there later must stay.
            removals.forget_all(tx)
            return references.referenced_in_any_schema(tx)
    finally:
        copy.close()


def _add(files: _Files, names: frozenset[str], progress: Progress | None) -> None:
    """Copies the files; records those that cannot be copied."""
    for done, sha256 in enumerate(sorted(names), 1):
        try:
            _copy_file(files, sha256)
        except (NotFound, FileNotFoundError):
            files.missing.add(sha256)
        except FileDamaged:
            files.damaged.add(sha256)
        if progress is not None:
            progress(done, len(names))


def _copy_file(files: _Files, sha256: str) -> None:
    with files.source.open(sha256) as content, files.target.stage(_Source(content)) as staged:
        refuse_damage(sha256, staged.sha256)
        staged.keep()


class _Source:
    """A file of the library. A failure to read it counts as damage of this file.

    Otherwise it would look like a failure to write the copy.
    """

    def __init__(self, file: BinaryIO) -> None:
        self._file = file

    def read(self, size: int, /) -> bytes:
        """At most `size` bytes; none at the end. Raises FileDamaged."""
        try:
            return self._file.read(size)
        except OSError as problem:
            raise FileDamaged() from problem


def _size_of(path: Path) -> int:
    return sum(file.stat().st_size for file in path.rglob("*") if file.is_file())
