"""Checks that a database and a folder of files belong to the same library.

Both hold the id of their library. Without this check, a start with a wrong database would move all
files to the quarantine, and a start with a wrong folder would store new files where a later start
does not find them.
"""

from __future__ import annotations

from dataclasses import dataclass

from app.errors import LibraryMismatch
from app.store.clips import versions as library
from app.store.database import schema
from app.store.database.engine import Database, Tx, database_file
from app.store.files.bucket import FilesPlace
from app.store.files.files import FileStore
from app.store.files.places import open_files
from app.store.jobs import references

WHAT_TO_DO = (
    "Move the database or the folder back, or correct KINEDEX_DATABASE_URL and KINEDEX_DATA_DIR. "
    "If you are sure that they belong together, run `kinedex db adopt-files`."
)


@dataclass(frozen=True, slots=True)
class AdoptionReport:
    """What `adopt` found in the folder of files.

    present, missing: numbers of files that the database names; unknown: number of other files,
    which the next sweep moves to the quarantine.
    """

    present: int
    missing: int
    unknown: int


def prepare(database_url: str, files_at: FilesPlace) -> str:
    """Makes an empty library or checks the existing one; returns its id. Every start calls this.

    Raises LibraryMismatch, before any change, if files and database do not belong together;
    DatabaseOutOfDate; StorageError.
    """
    if not is_database_there(database_url):
        _refuse_files(database_url, files_at)
        schema.upgrade(database_url)
    schema.check(database_url)
    return _checked(database_url, files_at, writes=True)


def check(database_url: str, files_at: FilesPlace) -> str:
    """As `prepare`, but makes nothing."""
    schema.check(database_url)
    return _checked(database_url, files_at, writes=False)


def check_copyable(database_url: str, files_at: FilesPlace) -> str | None:
    """As `check`, for a copy before an upgrade: the database may have an older schema.

    Returns None if that schema has no id of the library yet.
    """
    schema.check_known(database_url)
    database, files = Database(database_url), open_files(files_at)
    try:
        with database.read() as tx:
            ours = library.library_id_if_any(tx)
            if files.read_id() is None:
                _refuse_foreign_files(tx, files, database_url)
    finally:
        database.close()
    _refuse_other_library(ours, database_url, files)
    return ours


def refuse_files_without_database(database_url: str, files_at: FilesPlace) -> None:
    """Raises LibraryMismatch if there is no database, but the folder already holds files."""
    if not is_database_there(database_url):
        _refuse_files(database_url, files_at)


def _refuse_files(database_url: str, files_at: FilesPlace) -> None:
    files = open_files(files_at)
    if files.read_id() is None and next(iter(files), None) is None:
        return
    raise LibraryMismatch(
        f"There is no library in {_database_name(database_url)}, but {files.name} holds the "
        f"files of a library ({sum(1 for _ in files)} files). If the database was moved, put it "
        "back; if KINEDEX_DATABASE_URL or KINEDEX_DATA_DIR is wrong, correct it. To begin a new "
        "library, move that folder away; `kinedex import` can import the files in it."
    )


def is_database_there(database_url: str) -> bool:
    """Whether there is a database with any table. It does not make a database file."""
    file = database_file(database_url)
    if file is not None and not file.is_there:
        return False
    return not schema.state(database_url).is_empty


def adopt(database_url: str, files_at: FilesPlace) -> AdoptionReport:
    """Assigns the folder to the library of the database, even if it had another id.

    Raises LibraryMismatch if there is no database; DatabaseOutOfDate; StorageError.
    """
    if not is_database_there(database_url):
        raise LibraryMismatch(
            f"There is no library in {_database_name(database_url)} that could adopt files."
        )
    schema.check(database_url)
    database, files = Database(database_url), open_files(files_at)
    try:
        with database.read() as tx:
            ours, needed = library.library_id(tx), references.referenced(tx)
    finally:
        database.close()
    present = set(files)
    files.write_id(ours, replaces=True)
    return AdoptionReport(len(needed & present), len(needed - present), len(present - needed))


def _checked(database_url: str, files_at: FilesPlace, *, writes: bool) -> str:
    database, files = Database(database_url), open_files(files_at)
    try:
        with database.read() as tx:
            ours = library.library_id(tx)
            if files.read_id() is None:
                _refuse_foreign_files(tx, files, database_url)
                if writes:
                    files.write_id(ours)
    finally:
        database.close()
    _refuse_other_library(ours, database_url, files)
    return ours


def _refuse_other_library(ours: str | None, database_url: str, files: FileStore) -> None:
    theirs = files.read_id()
    if theirs is None or theirs == ours:
        return
    raise LibraryMismatch(
        f"{_database_name(database_url)} is the database of the library {ours or 'without an id'}, "
        f"but {files.name} holds the files of the library {theirs}. {WHAT_TO_DO}"
    )


def _refuse_foreign_files(tx: Tx, files: FileStore, database_url: str) -> None:
    """Checks a folder without an id: early versions of Kinedex wrote none.

    It belongs to the database if it holds at least half of the files that the database names.
    """
    needed = references.referenced_in_any_schema(tx)
    present = sum(1 for sha256 in needed if files.has(sha256))
    has_files = next(iter(files), None) is not None
    if not needed and not has_files:
        return
    if present and 2 * present >= len(needed):
        return
    raise LibraryMismatch(
        f"{_database_name(database_url)} names {len(needed)} files, and {files.name} holds "
        f"{present} of them{' and other files' if has_files else ''}. {WHAT_TO_DO}"
    )


def _database_name(database_url: str) -> str:
    file = database_file(database_url)
    return "the database of KINEDEX_DATABASE_URL" if file is None else str(file.path)
