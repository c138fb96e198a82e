"""Whether a database and a folder of files belong together.

Both hold the id of their library. A start without its database would otherwise take all files for
leftovers, and one with a wrong folder would store new files where they are not found again.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from app.errors import LibraryMismatch, StorageError
from app.store.clips import versions as library
from app.store.database import schema
from app.store.database.engine import Database, Tx, database_file
from app.store.files.files import FileStore
from app.store.files.id_file import read_id, write_id
from app.store.jobs import references

WHAT_TO_DO = (
    "Put back what was moved, or set KINEDEX_DATABASE_URL and KINEDEX_DATA_DIR right. If you are "
    "sure that they belong together, run `kinedex db adopt-files`."
)


@dataclass(frozen=True, slots=True)
class AdoptionReport:
    """What a database found in a folder that it was given.

    present, missing: files that the database names; unknown: others, which go to the quarantine.
    """

    present: int
    missing: int
    unknown: int


def prepare(database_url: str, files_dir: Path) -> str:
    """What a start does: makes an empty library, or checks one that is there; its id.

    Raises LibraryMismatch where files and database do not belong together, before anything is
    changed; DatabaseOutOfDate; StorageError.
    """
    if not is_database_there(database_url):
        _refuse_files(database_url, files_dir)
        schema.upgrade(database_url)
    schema.check(database_url)
    return _checked(database_url, files_dir, writes=True)


def check(database_url: str, files_dir: Path) -> str:
    """As `prepare`, but nothing is made."""
    schema.check(database_url)
    return _checked(database_url, files_dir, writes=False)


def refuse_files_without_database(database_url: str, files_dir: Path) -> None:
    """Raises LibraryMismatch where a new database would be made for a folder that is in use."""
    if not is_database_there(database_url):
        _refuse_files(database_url, files_dir)


def _refuse_files(database_url: str, files_dir: Path) -> None:
    files = FileStore(files_dir)
    if _read_id(files_dir) is None and next(iter(files), None) is None:
        return
    raise LibraryMismatch(
        f"There is no library in {_named(database_url)}, but {files_dir} is the folder of files "
        f"of one ({sum(1 for _ in files)} files). If the database was moved, put it back; if "
        "KINEDEX_DATABASE_URL or KINEDEX_DATA_DIR names the wrong place, set it right. To begin a "
        "new library, move that folder away; `kinedex import` can take in the files in it."
    )


def is_database_there(database_url: str) -> bool:
    """Whether there is a database with any table; makes none."""
    file = database_file(database_url)
    if file is not None and not file.is_there:
        return False
    return not schema.state(database_url).is_empty


def adopt(database_url: str, files_dir: Path) -> AdoptionReport:
    """Makes the folder that of the database's library, whatever it was before.

    Raises LibraryMismatch where there is no database; DatabaseOutOfDate; StorageError.
    """
    if not is_database_there(database_url):
        raise LibraryMismatch(f"There is no library in {_named(database_url)} to give files to.")
    schema.check(database_url)
    database, files = Database(database_url), FileStore(files_dir)
    try:
        with database.read() as tx:
            ours, needed = library.library_id(tx), references.referenced(tx)
    finally:
        database.close()
    present = set(files)
    _write_id(files_dir, ours, replaces=True)
    return AdoptionReport(len(needed & present), len(needed - present), len(present - needed))


def _checked(database_url: str, files_dir: Path, *, writes: bool) -> str:
    database, files = Database(database_url), FileStore(files_dir)
    try:
        with database.read() as tx:
            ours = library.library_id(tx)
            if _read_id(files_dir) is None:
                _refuse_foreign_files(tx, files, database_url)
                if writes:
                    _write_id(files_dir, ours)
    finally:
        database.close()
    theirs = _read_id(files_dir)
    if theirs is None or theirs == ours:
        return ours
    raise LibraryMismatch(
        f"{_named(database_url)} is the database of the library {ours}, but {files_dir} is the "
        f"folder of files of the library {theirs}. {WHAT_TO_DO}"
    )


def _refuse_foreign_files(tx: Tx, files: FileStore, database_url: str) -> None:
    """Of a folder without an id, as of an earlier Kinedex: most files that are named are there."""
    needed = references.referenced(tx)
    there = sum(1 for sha256 in needed if files.has(sha256))
    is_any = next(iter(files), None) is not None
    if not needed and not is_any:
        return
    if there and 2 * there >= len(needed):
        return
    raise LibraryMismatch(
        f"{_named(database_url)} names {len(needed)} files, of which {there} are in {files.root}, "
        f"where {'there are others' if is_any else 'there are none'}. {WHAT_TO_DO}"
    )


def _named(database_url: str) -> str:
    file = database_file(database_url)
    return "the database of KINEDEX_DATABASE_URL" if file is None else str(file.path)


def _read_id(files_dir: Path) -> str | None:
    try:
        return read_id(files_dir)
    except OSError as error:
        raise StorageError(f"The folder {files_dir} cannot be read: {error.strerror}") from error


def _write_id(files_dir: Path, library_id: str, *, replaces: bool = False) -> None:
    try:
        write_id(files_dir, library_id, replaces=replaces)
    except OSError as error:
        raise StorageError(f"The folder {files_dir} cannot be written: {error.strerror}") from error
