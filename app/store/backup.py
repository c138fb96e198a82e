"""A copy of a whole library, made while it is in use: its database and its files.

A copy is a data directory like any other: it is restored by running on it. The database is
copied at one moment; the files are named by their content and never change, so that they can
be copied before and after that moment. What is deleted meanwhile might be missing: then the
database is copied again, which takes no longer than that, until nothing is.
"""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from app.errors import BadField, DiskFull, NotFound, Place, StorageError
from app.store import references
from app.store.engine import Database
from app.store.files import NO_SPACE, FileStore, sync_directory
from app.store.store import Store

DATABASE, FILES = "kinedex.sqlite3", "files"
"""Names in a data directory."""

MOST_TRIES = 10
"""Each time a file was both added and deleted while its turn had not come."""

Progress = Callable[[int, int], None]
"""Is told how many files are there, of how many."""


@dataclass(frozen=True, slots=True)
class Backup:
    """What was copied; bytes: of the database and the files."""

    path: Path
    files: int
    bytes: int


def back_up(store: Store, path: Path, progress: Progress | None = None) -> Backup:
    """Copies the library to `path`, which has that name only when it is whole and on disk.

    Raises BadField where there is something already or nothing can be written,
    ConfigurationError for a database that is not SQLite, DiskFull, StorageError where a file of
    the library is gone or damaged; then nothing is left.
    """
    store.database.check_copyable()
    if os.path.lexists(path):
        message = f"{path} is there already: a copy never takes the place of anything"
        raise BadField(f"path: {message}", places=[Place("path", message)])
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        part = Path(tempfile.mkdtemp(prefix=f".{path.name}.", suffix=".part", dir=path.parent))
    except OSError as problem:
        message = f"nothing can be written to {path.parent}: {problem.strerror}"
        raise BadField(f"path: {message}", places=[Place("path", message)]) from None
    try:
        copied = _copy(store, part, progress)
        _rename(part, path)
    except OSError as problem:
        if problem.errno in NO_SPACE:
            raise DiskFull() from problem
        raise StorageError(f"The copy cannot be written: {problem.strerror}") from problem
    finally:
        shutil.rmtree(part, ignore_errors=True)
    return Backup(path, len(copied), _size_of(path))


def _copy(store: Store, part: Path, progress: Progress | None) -> frozenset[str]:
    """The names of the files that were copied with the database."""
    files = FileStore(part / FILES)
    files.root.mkdir()
    with store.read() as tx:
        needed = references.referenced(tx)
    _add(store.files, files, needed, progress)
    gone: frozenset[str] = frozenset()
    for _ in range(MOST_TRIES):
        needed, before = _copy_database(store.database, part / DATABASE), gone
        gone = _add(store.files, files, needed, progress)
        if not gone:
            for sha256 in frozenset(files) - needed:
                files.remove(sha256)
            return needed
        if gone == before:  # not deleted just now: lost
            break
    raise StorageError(
        f"{len(gone)} files that the library refers to are not there, as {sorted(gone)[0]}."
    )


def _copy_database(database: Database, path: Path) -> frozenset[str]:
    """Copies the database over what is there; the names of the files that it needs."""
    path.unlink(missing_ok=True)
    database.copy_to(path)
    copy = Database.at(path)
    try:
        with copy.read() as tx:
            return references.referenced(tx)
    finally:
        copy.close()


def _add(
    source: FileStore, target: FileStore, names: frozenset[str], progress: Progress | None
) -> frozenset[str]:
    """Copies those of the files that are not there yet; the names of those that are gone."""
    gone = set()
    waiting = names - frozenset(target)
    for done, sha256 in enumerate(sorted(waiting), len(names) - len(waiting) + 1):
        try:
            _copy_file(source, target, sha256)
        except (NotFound, FileNotFoundError):
            gone.add(sha256)
        if progress is not None:
            progress(done, len(names))
    return frozenset(gone)


def _copy_file(source: FileStore, target: FileStore, sha256: str) -> None:
    with source.open(sha256) as content, target.stage(content) as staged:
        if staged.sha256 != sha256:
            raise StorageError(f"The file {sha256} of the library is damaged.")
        staged.keep()


def _rename(part: Path, path: Path) -> None:
    """Gives the copy its name, and sees to it that this is on disk; it stays its maker's own."""
    for folder in (part, part / FILES):
        sync_directory(folder)
    part.rename(path)
    sync_directory(path.parent)


def _size_of(path: Path) -> int:
    return sum(file.stat().st_size for file in path.rglob("*") if file.is_file())
