"""Opens a database. Only this module depends on the kind of database.

SQLite uses a write-ahead log. Every commit is synced (`synchronous=FULL`), so that stored data
survive kill -9 and a power cut. Writers take their lock at the beginning (`BEGIN IMMEDIATE`), so
that no transaction fails in the middle because another one wrote first. Readers see one snapshot.
"""

from __future__ import annotations

import json
import sqlite3
import threading
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any, Self

from pydantic_core import from_json
from sqlalchemy import Connection, Engine, create_engine, event, func, select
from sqlalchemy.engine import URL, make_url
from sqlalchemy.exc import ArgumentError, DBAPIError

from app.errors import ConfigurationError, DatabaseDamaged, DatabaseGone, DiskFull, StorageError
from app.store.database import integrity
from app.store.database.database_file import DatabaseFile
from app.store.folders import make_private

BUSY_TIMEOUT_S = 30.0
POOL_SIZE = 8
POOL_OVERFLOW = 56
"""With POOL_SIZE, more connections than the 58 threads of the API, so that no reader waits."""
ERASE_WAIT_S = 2.0
"""How long `erase_traces` waits for readers; the worker tries again each minute."""
WRITES_OPTION = "kinedex_writes"
"""Execution option of a connection whose transaction writes."""
MIGRATION_LOCK = 0x6B696E65
"""Number of an advisory lock of PostgreSQL ("kine"); any number that nobody else uses."""

_UNUSABLE = frozenset(
    {
        sqlite3.SQLITE_READONLY,
        sqlite3.SQLITE_CANTOPEN,
        sqlite3.SQLITE_IOERR,
        sqlite3.SQLITE_PERM,
    }
)
"""Result codes of SQLite that mean a failure of the file or the disk, not of the statement."""

Tx = Connection
"""A running transaction, from `Database.read()` or `Database.write()`."""


class Database:
    """An engine with its read and write transactions; safe to share between threads."""

    def __init__(self, url: str | URL, *, foreign_keys: bool = True) -> None:
        """Opens no connection yet. `foreign_keys=False` is for migrations, which rebuild tables.

        Raises ConfigurationError for a URL that cannot be used.
        """
        parsed = _parsed(url)
        self.file = database_file(parsed)
        """The file of an SQLite database; None for a database server."""
        self.damage: str | None = None
        """The message of the last transaction that met damage, until `clear_damage`."""
        self.engine = _open_engine(parsed, self.file, foreign_keys=foreign_keys)
        self._is_sqlite = self.engine.dialect.name == "sqlite"
        self._reader = self.engine if self._is_sqlite else _snapshot_reader(self.engine)
        self._writer = self.engine.execution_options(**{WRITES_OPTION: True})
        # The threads of one process wait for each other here, which is faster than SQLite's
        # waiting: that polls the lock. Processes still poll.
        self._write_lock = threading.Lock()

    @classmethod
    def at(cls, path: Path) -> Self:
        """The SQLite database in the file at `path`, which may contain any characters."""
        return cls(URL.create("sqlite", database=str(path)))

    @contextmanager
    def read(self) -> Iterator[Tx]:
        """A transaction that reads one snapshot. It is rolled back at the end of the block.

        Raises DatabaseGone, DatabaseDamaged, StorageError.
        """
        with self._storage_failures(), self._reader.connect() as connection:
            yield connection

    @contextmanager
    def write(self) -> Iterator[Tx]:
        """A transaction that is committed durably when the block ends without an exception.

        Do not nest. Raises DiskFull; DatabaseGone; DatabaseDamaged; StorageError, also if another
        writer holds the lock for BUSY_TIMEOUT_S.
        """
        with self._writer_lock(), self._storage_failures(), self._writer.begin() as connection:
            yield connection

    @contextmanager
    def migrate(self) -> Iterator[Tx]:
        """A write transaction during which no other process can migrate."""
        with self.write() as tx:
            if not self._is_sqlite:  # SQLite has only one writer at a time
                tx.execute(select(func.pg_advisory_xact_lock(MIGRATION_LOCK)))
            yield tx

    def watch_file(self) -> None:
        """Refuses, from now on, another file with the name of this one. Raises DatabaseGone."""
        if self.file is not None:
            try:
                self.file.watch()
            except OSError as error:
                raise DatabaseGone() from error

    def erase_traces(self, wait_s: float = ERASE_WAIT_S) -> bool:
        """Moves the changes in SQLite's log into the database file and empties the log.

        Deleted rows are overwritten in the file (`secure_delete`), so after this no file holds
        them. It also frees the disk space of the log. Other databases do this themselves.

        wait_s: seconds to wait for readers and writers. Returns False if they were still active.
        Raises StorageError.
        """
        if not self._is_sqlite:
            return True
        with self._storage_failures():
            connection = self.engine.raw_connection()
            try:
                cursor = connection.cursor()
                cursor.execute(f"PRAGMA busy_timeout = {round(1000 * wait_s)}")
                # The first column of the result is 1 if the checkpoint was blocked.
                return not cursor.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchone()[0]
            finally:
                # The connection goes back into the pool, so its usual timeout is restored.
                connection.cursor().execute(f"PRAGMA busy_timeout = {round(1000 * BUSY_TIMEOUT_S)}")
                connection.close()

    def clear_damage(self) -> None:
        """Records that a damaged database is whole again.

        Pooled connections may still have damaged pages in memory, so all of them are replaced.
        """
        self.damage = None
        self.engine.dispose()

    def find_damage(self, *, quick: bool = False) -> tuple[str, ...]:
        """The findings of `integrity.find_damage` for an SQLite database; () for any other.

        Raises DatabaseGone, StorageError.
        """
        if self.file is None:
            return ()
        self.file.check()
        # A new connection, because pooled ones read pages from their cache, not from the file.
        with closing(sqlite3.connect(self.file.path, timeout=BUSY_TIMEOUT_S)) as connection:
            return integrity.find_damage(connection, quick=quick)

    def check_copyable(self) -> None:
        """Raises ConfigurationError if `copy_to` cannot copy this database: only SQLite's files."""
        if not self._is_sqlite:
            raise ConfigurationError(
                f"Kinedex copies SQLite databases only, and this one is {self.engine.dialect.name}:"
                " copy the folder of files, dump the database with its own program (pg_dump), and"
                " copy what is new in the folder after that."
            )

    def copy_to(self, path: Path) -> None:
        """Copies one snapshot of the database to `path`, while others read and write.

        Call `check_copyable` before. Raises DiskFull, StorageError.
        """
        connection = self.engine.raw_connection()
        try:
            with closing(sqlite3.connect(path)) as copy:
                # All pages in one step, so that they belong to one snapshot. No writer waits.
                connection.driver_connection.backup(copy)  # type: ignore[union-attr]
        except sqlite3.Error as error:
            code = getattr(error, "sqlite_errorcode", None)
            if code == sqlite3.SQLITE_FULL:
                raise DiskFull() from error
            raise StorageError(f"The database cannot be copied: {error}") from error
        finally:
            connection.close()

    def close(self) -> None:
        """Closes all connections."""
        self.engine.dispose()

    @contextmanager
    def _storage_failures(self) -> Iterator[None]:
        """Checks the file of the database, and converts exceptions of the driver to ours."""
        if self.file is not None:
            self.file.check()
        try:
            yield
        except (DBAPIError, sqlite3.Error) as error:
            cause = error.orig if isinstance(error, DBAPIError) else error
            failure = _as_storage_error(cause)
            if failure is None:
                raise
            if isinstance(failure, DatabaseDamaged):
                self.damage = failure.detail  # `Health` then checks all pages
            raise failure from error

    @contextmanager
    def _writer_lock(self) -> Iterator[None]:
        if not self._is_sqlite:
            yield
            return
        if not self._write_lock.acquire(timeout=BUSY_TIMEOUT_S):
            raise StorageError("The database stayed locked by another writer of this process")
        try:
            yield
        finally:
            self._write_lock.release()


def _snapshot_reader(engine: Engine) -> Engine:
    return engine.execution_options(isolation_level="REPEATABLE READ", postgresql_readonly=True)


def database_file(url: URL | str) -> DatabaseFile | None:
    """The file of an SQLite database, which may not exist yet; None for any other database."""
    parsed = _parsed(url)
    if parsed.get_backend_name() != "sqlite" or "uri" in parsed.query or not parsed.database:
        return None
    return DatabaseFile(Path(parsed.database))


def _parsed(url: URL | str) -> URL:
    try:
        return make_url(url)
    except ArgumentError as error:
        raise ConfigurationError("KINEDEX_DATABASE_URL is not a database URL") from error


def _open_engine(parsed: URL, file: DatabaseFile | None, *, foreign_keys: bool) -> Engine:
    # hide_parameters: logs and tracebacks must not hold the content of rows.
    common: dict[str, Any] = {
        "json_serializer": _to_json,
        "json_deserializer": from_json,
        "hide_parameters": True,
        "pool_size": POOL_SIZE,
        "max_overflow": POOL_OVERFLOW,
    }
    if parsed.get_backend_name() == "sqlite":
        return _open_sqlite(parsed, file, common, foreign_keys=foreign_keys)
    try:
        return create_engine(parsed, pool_pre_ping=True, **common)
    except (ArgumentError, ImportError) as error:
        raise ConfigurationError(
            f"KINEDEX_DATABASE_URL: there is no driver for {parsed.drivername} databases"
        ) from error


def _to_json(value: object) -> str:
    # JSON has no NaN: other programs could not read such a column.
    return json.dumps(value, allow_nan=False, ensure_ascii=False)


def _open_sqlite(
    url: URL, file: DatabaseFile | None, common: dict[str, Any], *, foreign_keys: bool
) -> Engine:
    if not url.database or url.database == ":memory:":
        raise ConfigurationError(
            "Processes cannot share an SQLite database in memory: name a file in "
            "KINEDEX_DATABASE_URL"
        )
    _make_folder(Path(url.database).parent)
    engine = create_engine(url, connect_args={"timeout": BUSY_TIMEOUT_S}, **common)

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
        writes = connection.get_execution_options().get(WRITES_OPTION, False)
        connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")

    return engine


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
    deadline = time.monotonic() + BUSY_TIMEOUT_S
    while connection.execute("PRAGMA journal_mode").fetchone()[0] != "wal":
        try:
            connection.execute("PRAGMA journal_mode = WAL")
        except sqlite3.OperationalError:
            if time.monotonic() > deadline:
                raise
            time.sleep(0.01)


def _as_storage_error(error: BaseException | None) -> StorageError | None:
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
