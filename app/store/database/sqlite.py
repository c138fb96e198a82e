"""SQLite: how a database is opened, and what its errors mean.

It uses a write-ahead log. Every commit is synced (`synchronous=FULL`), so that stored data survive
kill -9 and a power cut. Writers take their lock at the beginning (`BEGIN IMMEDIATE`), so that no
transaction fails in the middle because another one wrote first. Readers see one snapshot.
"""

from __future__ import annotations

import sqlite3
import time
from pathlib import Path
from typing import Any

from sqlalchemy import Connection, Engine, create_engine, event
from sqlalchemy.engine import URL

from app.errors import ConfigurationError, DatabaseDamaged, DiskFull, StorageError
from app.store.database.access import LOCK_TIMEOUT_S, Access, access_of
from app.store.database.database_file import DatabaseFile
from app.store.folders import make_private

_UNUSABLE = frozenset(
    {
        sqlite3.SQLITE_READONLY,
        sqlite3.SQLITE_CANTOPEN,
        sqlite3.SQLITE_IOERR,
        sqlite3.SQLITE_PERM,
    }
)
"""Result codes that mean a failure of the file or the disk, not of the statement."""


def open_engine(
    url: URL, file: DatabaseFile | None, common: dict[str, Any], *, foreign_keys: bool
) -> Engine:
    """An engine for the database; common: arguments of `create_engine`.

    Raises ConfigurationError for a database in memory, or if its folder cannot be made.
    """
    if not url.database or url.database == ":memory:":
        raise ConfigurationError(
            "Processes cannot share an SQLite database in memory: name a file in "
            "KINEDEX_DATABASE_URL"
        )
    _make_folder(Path(url.database).parent)
    engine = create_engine(url, connect_args={"timeout": LOCK_TIMEOUT_S}, **common)

    @event.listens_for(engine, "do_connect")
    def _check_file(*_: object) -> None:
        # Without this, SQLite would make a new file if the opened one was moved away.
        if file is not None:
            _open_file(file)

    @event.listens_for(engine, "connect")
    def _prepare(connection: sqlite3.Connection, _record: object) -> None:
        connection.isolation_level = None  # the driver sends no BEGIN: `_begin` does, below
        connection.execute("PRAGMA synchronous = FULL")
        connection.execute("PRAGMA secure_delete = ON")  # deleted personal data are overwritten
        connection.execute(f"PRAGMA foreign_keys = {'ON' if foreign_keys else 'OFF'}")
        _ensure_wal(connection)

    @event.listens_for(engine, "begin")
    def _begin(connection: Connection) -> None:
        writes = access_of(connection) in (Access.WRITE, Access.WRITE_ROW)
        connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")

    return engine


def failure_of(error: BaseException | None) -> StorageError | None:
    """What an error of the driver means; None if it is no failure of the store."""
    code = getattr(error, "sqlite_errorcode", None)
    # SHMSIZE: SQLite cannot make its shared-memory file, which needs space too.
    if code in (sqlite3.SQLITE_FULL, sqlite3.SQLITE_IOERR_SHMSIZE):
        return DiskFull()
    if code is None:
        return None
    # The low byte is the primary result code; the others refine it.
    if code & 0xFF in (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB):
        return DatabaseDamaged(f"The database is damaged: {error}")
    if code & 0xFF in (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED):
        return StorageError("The database stayed locked by another writer")
    if code & 0xFF in _UNUSABLE:
        return StorageError(f"The database cannot be used: {error}")
    return None


def _make_folder(folder: Path) -> None:
    try:
        make_private(folder)
    except OSError as error:
        raise ConfigurationError(
            f"The folder {folder} of the database cannot be made: {error.strerror}"
        ) from error


def _open_file(file: DatabaseFile) -> None:
    try:
        file.open()
    except OSError as error:
        raise StorageError(
            f"The database {file.path} cannot be opened: {error.strerror}"
        ) from error


def _ensure_wal(connection: sqlite3.Connection) -> None:
    # The file stores the mode. If two processes create the file at the same time, one can meet a
    # lock for which SQLite does not call its busy handler. Therefore the loop.
    deadline = time.monotonic() + LOCK_TIMEOUT_S
    while connection.execute("PRAGMA journal_mode").fetchone()[0] != "wal":
        try:
            connection.execute("PRAGMA journal_mode = WAL")
        except sqlite3.OperationalError:
            if time.monotonic() > deadline:
                raise
            time.sleep(0.01)
