"""Opening a database; the only module that knows which database it is.

SQLite: write-ahead log, every commit synced (`synchronous=FULL`: stored means that it
survives kill -9 and a power cut), writers take their lock at once (`BEGIN IMMEDIATE`, so a
transaction never fails half-way because another one wrote first), readers see one snapshot.
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

from sqlalchemy import Connection, Engine, create_engine, event, func, select
from sqlalchemy.engine import URL, make_url
from sqlalchemy.exc import ArgumentError, DBAPIError

from app.errors import ConfigurationError, DatabaseDamaged, DatabaseGone, DiskFull, StorageError
from app.store.database import integrity
from app.store.database.database_file import DatabaseFile
from app.store.folders import make_private

BUSY_TIMEOUT_S = 30.0
POOL_SIZE = 8
POOL_OVERFLOW = 56  # above the 58 threads that the API runs, so that a reader never waits
ERASE_WAIT_S = 2.0
"""A forgetting waits so long for readers; the worker tries again each minute."""
WRITES_OPTION = "kinedex_writes"
MIGRATION_LOCK = 0x6B696E65  # "kine": any number that no one else locks

_UNUSABLE = frozenset(
    {
        sqlite3.SQLITE_READONLY,
        sqlite3.SQLITE_CANTOPEN,
        sqlite3.SQLITE_IOERR,
        sqlite3.SQLITE_PERM,
    }
)
"""SQLite's results that tell of the file or its disk rather than of what was asked."""

Tx = Connection
"""A running transaction, as `Database.read()` and `Database.write()` give it."""


class Database:
    """An engine and its two kinds of transaction; safe to share between threads."""

    def __init__(self, url: str | URL, *, foreign_keys: bool = True) -> None:
        """Connects lazily. `foreign_keys=False` is for migrations, which rebuild tables."""
        parsed = _parsed(url)
        self.file = database_file(parsed)
        """The file of an SQLite database; None where the database is a server's."""
        self.damage: str | None = None
        """What a transaction said of damage, until somebody who has looked clears it."""
        self.engine = _open_engine(parsed, self.file, foreign_keys=foreign_keys)
        self._is_sqlite = self.engine.dialect.name == "sqlite"
        self._reader = self.engine if self._is_sqlite else _snapshot_reader(self.engine)
        self._writer = self.engine.execution_options(**{WRITES_OPTION: True})
        # Threads of one process queue here rather than poll SQLite's lock; processes poll.
        self._turn = threading.Lock()

    @classmethod
    def at(cls, path: Path) -> Self:
        """The SQLite database in the file at `path`, whatever characters the path holds."""
        return cls(URL.create("sqlite", database=str(path)))

    @contextmanager
    def read(self) -> Iterator[Tx]:
        """A transaction that sees one snapshot; nothing written in it is kept.

        Raises DatabaseGone, DatabaseDamaged, StorageError, as `write` does too.
        """
        with self._storage_failures(), self._reader.connect() as connection:
            yield connection

    @contextmanager
    def write(self) -> Iterator[Tx]:
        """A transaction that is committed, durably, when the block ends without an exception.

        Do not nest. Raises DiskFull, or StorageError when the lock is not had in time.
        """
        with self._my_turn(), self._storage_failures(), self._writer.begin() as connection:
            yield connection

    @contextmanager
    def migrate(self) -> Iterator[Tx]:
        """A write transaction that keeps any other process from migrating meanwhile."""
        with self.write() as tx:
            if not self._is_sqlite:  # whose writers take turns anyway
                tx.execute(select(func.pg_advisory_xact_lock(MIGRATION_LOCK)))
            yield tx

    def watch_file(self) -> None:
        """From now on, another file in the place of this one is refused. Raises DatabaseGone."""
        if self.file is not None:
            try:
                self.file.watch()
            except OSError as error:
                raise DatabaseGone() from error

    def erase_traces(self, wait_s: float = ERASE_WAIT_S) -> bool:
        """Writes the log of changes into the database and empties it; whether nobody was in the
        way. It waits so long for those who read or write.

        SQLite's; what is deleted is overwritten there (secure_delete). Elsewhere the
        database's own vacuuming does it. It also gives back the disk space of that log.
        """
        if not self._is_sqlite:
            return True
        with self._storage_failures():
            connection = self.engine.raw_connection()
            try:
                cursor = connection.cursor()
                cursor.execute(f"PRAGMA busy_timeout = {round(1000 * wait_s)}")
                return not cursor.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchone()[0]
            finally:
                connection.cursor().execute(f"PRAGMA busy_timeout = {round(1000 * BUSY_TIMEOUT_S)}")
                connection.close()

    def clear_damage(self) -> None:
        """Says that the database, which was damaged, is whole again.

        Connections of the pool may have kept damaged pages in memory, so new ones are opened.
        """
        self.damage = None
        self.engine.dispose()

    def find_damage(self, *, quick: bool = False) -> tuple[str, ...]:
        """What is wrong with an SQLite database (see `integrity`); () for any other.

        Raises DatabaseGone, StorageError.
        """
        if self.file is None:
            return ()
        self.file.check()
        # A connection of its own: those in use would show the pages that they remember.
        with closing(sqlite3.connect(self.file.path, timeout=BUSY_TIMEOUT_S)) as connection:
            return integrity.find_damage(connection, quick=quick)

    def check_copyable(self) -> None:
        """Raises ConfigurationError unless the database is a file (SQLite's), for `copy_to`."""
        if not self._is_sqlite:
            raise ConfigurationError(
                f"Kinedex copies SQLite databases only, and this one is {self.engine.dialect.name}:"
                " copy the folder of files, dump the database with its own program (pg_dump), and"
                " copy what is new in the folder after that."
            )

    def copy_to(self, path: Path) -> None:
        """Writes a copy of the database as it is at one moment, while others read and write.

        See `check_copyable`. Raises DiskFull, StorageError.
        """
        connection = self.engine.raw_connection()
        try:
            with closing(sqlite3.connect(path)) as copy:
                # All pages in one step: they are those of one snapshot, and no writer waits.
                connection.driver_connection.backup(copy)  # type: ignore[union-attr]
        except sqlite3.Error as error:
            code = getattr(error, "sqlite_errorcode", None)
            if code == sqlite3.SQLITE_FULL:
                raise DiskFull() from error
            raise StorageError(f"The database cannot be copied: {error}") from error
        finally:
            connection.close()

    def close(self) -> None:
        """Gives back all connections."""
        self.engine.dispose()

    @contextmanager
    def _storage_failures(self) -> Iterator[None]:
        """Failures of the database as ours; its file is looked at first."""
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
                self.damage = failure.detail
            raise failure from error

    @contextmanager
    def _my_turn(self) -> Iterator[None]:
        if not self._is_sqlite:
            yield
            return
        if not self._turn.acquire(timeout=BUSY_TIMEOUT_S):
            raise StorageError("The database stayed locked by another writer of this process")
        try:
            yield
        finally:
            self._turn.release()


def _snapshot_reader(engine: Engine) -> Engine:
    return engine.execution_options(isolation_level="REPEATABLE READ", postgresql_readonly=True)


def database_file(url: URL | str) -> DatabaseFile | None:
    """The file of an SQLite database that is there or is to be made; None for any other."""
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
    # allow_nan: JSON has no NaN; hide_parameters: no content of rows in logs and tracebacks.
    common: dict[str, Any] = {
        "json_serializer": _to_json,
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
    return json.dumps(value, allow_nan=False, ensure_ascii=False)


def _open_sqlite(
    url: URL, file: DatabaseFile | None, common: dict[str, Any], *, foreign_keys: bool
) -> Engine:
    if not url.database or url.database == ":memory:":
        raise ConfigurationError(
            "SQLite in memory is not shared by processes: give KINEDEX_DATABASE_URL a file"
        )
    _make_folder(Path(url.database).parent)
    engine = create_engine(url, connect_args={"timeout": BUSY_TIMEOUT_S}, **common)

    @event.listens_for(engine, "do_connect")
    def _look_first(*_: object) -> None:
        # SQLite would make a new file where the opened one was moved away.
        if file is not None:
            _open_file(file)

    @event.listens_for(engine, "connect")
    def _prepare(connection: sqlite3.Connection, _record: object) -> None:
        connection.isolation_level = None  # we say BEGIN ourselves, below
        connection.execute("PRAGMA synchronous = FULL")
        connection.execute("PRAGMA secure_delete = ON")  # who is forgotten leaves no trace
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
    # The mode is kept in the file. Two processes that create it at once can meet a lock for
    # which SQLite does not call its busy handler, hence the loop.
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
    if code in (sqlite3.SQLITE_FULL, sqlite3.SQLITE_IOERR_SHMSIZE):
        return DiskFull()
    if code is None:
        return None
    if code & 0xFF in (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB):
        return DatabaseDamaged(f"The database is damaged: {error}")
    if code & 0xFF in (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED):
        return StorageError("The database stayed locked by another writer")
    if code & 0xFF in _UNUSABLE:
        return StorageError(f"The database cannot be used: {error}")
    return None
