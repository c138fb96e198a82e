"""A copy of a whole library, made while it is in use: its database and its files.

A copy is a data directory like any other: it is restored by running on it. The database is
copied at one moment; the files are named by their content and never change, so that they can
be copied before and after that moment. What is deleted meanwhile might be missing: then the
database is copied again, which takes no longer than that, until nothing is.

A copy that cannot be relied on is worse than none: the copied database is checked page by page,
and each file against its name.
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

from app.errors import (
    BadField,
    DatabaseDamaged,
    DiskFull,
    FileDamaged,
    NotFound,
    Place,
    StorageError,
)
from app.store.clips import versions as library
from app.store.database.engine import Database
from app.store.files.files import NO_SPACE, FileStore
from app.store.files.hash_check import refuse_damage
from app.store.files.id_file import write_id
from app.store.files.locked_file import locked_folder, remove_if_abandoned
from app.store.folders import sync_folder
from app.store.jobs import references, removals
from app.store.store import Store

DATABASE, FILES = "kinedex.sqlite3", "files"
"""Names in a data directory."""

PART = ".part"
"""Ending of a copy that is being made."""

MAX_TRIES = 10
"""Each time a file was both added and deleted while its turn had not come."""

Progress = Callable[[int, int], None]
"""Is told how many files are there, of how many."""


@dataclass(frozen=True, slots=True)
class Backup:
    """What was copied; bytes: of the database and the files."""

    path: Path
    files: int
    bytes: int


@dataclass(slots=True)
class _Files:
    """The files of a library and of its copy; and which of them could not be copied."""

    source: FileStore
    target: FileStore
    missing: set[str] = field(default_factory=set)
    damaged: set[str] = field(default_factory=set)


def back_up(store: Store, path: Path, progress: Progress | None = None) -> Backup:
    """Copies the library to `path`, which has that name only when it is whole and on disk.

    Raises BadField where there is something already or nothing can be written,
    ConfigurationError for a database that is not SQLite, DiskFull, DatabaseDamaged, and
    StorageError that names each file of the library that is gone or damaged; then nothing is
    left. What a copy left that was killed is removed by the next one beside it.
    """
    store.database.check_copyable()
    if os.path.lexists(path):
        message = f"{path} is there already: a copy never takes the place of anything"
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
    """Removes copies whose maker died: hidden folders that hold nothing but what a copy does."""
    for part in folder.glob(f".*{PART}"):
        if _is_a_copy(part):
            remove_if_abandoned(part, partial(shutil.rmtree, ignore_errors=True))


def _is_a_copy(part: Path) -> bool:
    try:
        names = {each.name.partition("-")[0] for each in part.iterdir()}  # without "-wal"
    except OSError:
        return False
    return names <= {DATABASE, FILES}


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
    """The names of the files that were copied with the database."""
    with store.read() as tx:
        needed, library_id = references.referenced(tx), library.library_id(tx)
    write_id(part / FILES, library_id)
    files = _Files(store.files, FileStore(part / FILES))
    _add(files, needed, progress)
    lost: set[str] = set()
    for _ in range(MAX_TRIES):
        needed, before = _copy_database(store.database, part / DATABASE), lost
        _add(files, needed, progress)
        lost = files.missing | files.damaged
        if not lost:
            for sha256 in frozenset(files.target) - needed:
                files.target.remove(sha256)
            return needed
        if lost == before:  # not deleted just now
            break
    raise _not_whole(files)


def _not_whole(files: _Files) -> StorageError:
    places = [Place(name, "is not there") for name in sorted(files.missing)]
    places += [Place(name, "is damaged") for name in sorted(files.damaged)]
    return StorageError(
        f"Of the files that the library refers to, {len(files.missing)} are not there and "
        f"{len(files.damaged)} are damaged; nothing was copied.",
        places=places,
    )


def _copy_database(database: Database, path: Path) -> frozenset[str]:
    """Copies the database over what is there; the names of the files that it needs.

    Raises DatabaseDamaged: a copy has the pages of the original, and so its damage.
    """
    path.unlink(missing_ok=True)
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
            # Their files are not in the copy; a later file of the same name must stay.
            removals.forget_all(tx)
            return references.referenced(tx)
    finally:
        copy.close()


def _add(files: _Files, names: frozenset[str], progress: Progress | None) -> None:
    """Copies those of the files that are not there yet; notes those that cannot be copied."""
    files.missing, files.damaged = set(), set()
    waiting = names - frozenset(files.target)
    for done, sha256 in enumerate(sorted(waiting), len(names) - len(waiting) + 1):
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
    """A file of the library; that it cannot be read is damage too, and not the copy's failure."""

    def __init__(self, file: BinaryIO) -> None:
        self._file = file

    def read(self, size: int, /) -> bytes:
        """As a file does. Raises FileDamaged."""
        try:
            return self._file.read(size)
        except OSError as problem:
            raise FileDamaged() from problem


def _size_of(path: Path) -> int:
    return sum(file.stat().st_size for file in path.rglob("*") if file.is_file())
