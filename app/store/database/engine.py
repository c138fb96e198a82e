"""A database with its transactions. `sqlite` and `postgresql` know what each kind needs.

Readers see one snapshot. Writers run one after the other, and a commit survives kill -9 and a
power cut.
"""

from __future__ import annotations

import json
import sqlite3
import threading
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any, Self

from pydantic_core import from_json
from sqlalchemy import Connection, Engine
from sqlalchemy.engine import URL, make_url
from sqlalchemy.exc import ArgumentError, DBAPIError
from sqlalchemy.exc import TimeoutError as PoolTimeout

from app.errors import ConfigurationError, DatabaseDamaged, DatabaseGone, DiskFull, StorageError
from app.store.database import integrity, postgresql, sqlite
from app.store.database.access import LOCK_TIMEOUT_S, Access, ServerOptions, options_for
from app.store.database.database_file import DatabaseFile

POOL_SIZE = 8
POOL_OVERFLOW = 56
"""With POOL_SIZE, more connections than the 58 threads of the API, so that no reader waits. A
database server has its own limit: see `ServerOptions`."""
ERASE_WAIT_S = 2.0
"""How long `erase_traces` waits for readers; the worker tries again each minute."""
MAX_REBUILT_BYTES = 2**30
"""The largest file that is written anew while others use it: it takes about 10 s on a disk."""

Tx = Connection
"""A running transaction, from `Database.read()` or `Database.write()`."""


class Database:
    """An engine with its read and write transactions; safe to share between threads."""

    def __init__(
        self,
        url: str | URL,
        *,
        foreign_keys: bool = True,
        options: ServerOptions | None = None,
    ) -> None:
        """Opens no connection yet. `foreign_keys=False` is for migrations, which rebuild tables.

        Raises ConfigurationError for a URL that cannot be used.
        """
        parsed = _parsed(url)
        self.file = database_file(parsed)
        """The file of an SQLite database; None for a database server."""
        self.damage: str | None = None
        """The message of the last transaction that met damage, until `clear_damage`."""
        self.engine = _open_engine(
            parsed, self.file, options or ServerOptions(), foreign_keys=foreign_keys
        )
        self.is_sqlite = self.engine.dialect.name == "sqlite"
        self._with = {
            access: self.engine.execution_options(**options_for(access)) for access in Access
        }
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
        with self._storage_failures(), self._with[Access.READ].connect() as connection:
            yield connection

    @contextmanager
    def write(self) -> Iterator[Tx]:
        """A transaction that is committed durably when the block ends without an exception.

        Do not nest. Raises DiskFull; DatabaseGone; DatabaseDamaged; StorageError, also if another
        writer holds the lock for LOCK_TIMEOUT_S.
        """
        with self._begun(Access.WRITE) as connection:
            yield connection

    @contextmanager
    def write_row(self) -> Iterator[Tx]:
        """As `write`, to change one row by one statement.

        A database server does not make it wait for writers of other rows.
        """
        with self._begun(Access.WRITE_ROW) as connection:
            yield connection

    @contextmanager
    def migrate(self) -> Iterator[Tx]:
        """A write transaction during which no other process can migrate."""
        with self.write() as tx:
            if not self.is_sqlite:
                postgresql.lift_time_limits(tx)
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
        if not self.is_sqlite:
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
                connection.cursor().execute(f"PRAGMA busy_timeout = {round(1000 * LOCK_TIMEOUT_S)}")
                connection.close()

    def rebuild(self) -> bool:
        """Writes an SQLite file anew, without the bytes that no row uses.

        SQLite overwrites deleted rows, but not the copies that a page keeps of rows that moved to
        another page. Writers wait meanwhile, so a file over MAX_REBUILT_BYTES stays as it is.
        Returns whether no such bytes are left.
        """
        if self.file is None:
            return True
        if self.file.path.stat().st_size > MAX_REBUILT_BYTES:
            return False
        try:
            with closing(sqlite3.connect(self.file.path, timeout=LOCK_TIMEOUT_S)) as connection:
                connection.execute("VACUUM")
        except sqlite3.Error:  # no space for the copy, or another process writes all the time
            return False
        return True

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
        with closing(sqlite3.connect(self.file.path, timeout=LOCK_TIMEOUT_S)) as connection:
            return integrity.find_damage(connection, quick=quick)

    def copy_to(self, path: Path) -> None:
        """Copies one snapshot of an SQLite database to `path`, while others read and write.

        Raises DiskFull, StorageError.
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
    def _begun(self, access: Access) -> Iterator[Tx]:
        writer = self._with[access]
        with self._writer_lock(), self._storage_failures(), writer.begin() as connection:
            yield connection

    @contextmanager
    def _storage_failures(self) -> Iterator[None]:
        """Checks the file of the database, and converts exceptions of the driver to ours."""
        if self.file is not None:
            self.file.check()
        try:
            yield
        except PoolTimeout as error:
            raise StorageError("All connections to the database stayed in use") from error
        except (DBAPIError, sqlite3.Error) as error:
            cause = error.orig if isinstance(error, DBAPIError) else error
            failure = (sqlite if self.is_sqlite else postgresql).failure_of(cause)
            if failure is None:
                raise
            if isinstance(failure, DatabaseDamaged):
                self.damage = failure.detail  # `Health` then checks all pages
            raise failure from error

    @contextmanager
    def _writer_lock(self) -> Iterator[None]:
        if not self.is_sqlite:
            yield
            return
        if not self._write_lock.acquire(timeout=LOCK_TIMEOUT_S):
            raise StorageError("The database stayed locked by another writer of this process")
        try:
            yield
        finally:
            self._write_lock.release()


def database_file(url: URL | str) -> DatabaseFile | None:
    """The file of an SQLite database, which may not exist yet; None for any other database."""
    parsed = _parsed(url)
    if parsed.get_backend_name() != "sqlite" or "uri" in parsed.query or not parsed.database:
        return None
    return DatabaseFile(Path(parsed.database))


def _parsed(url: URL | str) -> URL:
    try:
        return postgresql.with_driver(make_url(url))
    except ArgumentError as error:
        raise ConfigurationError("KINEDEX_DATABASE_URL is not a database URL") from error


def _open_engine(
    parsed: URL, file: DatabaseFile | None, options: ServerOptions, *, foreign_keys: bool
) -> Engine:
    # hide_parameters: logs and tracebacks must not hold the content of rows.
    common: dict[str, Any] = {
        "json_serializer": _to_json,
        "json_deserializer": from_json,
        "hide_parameters": True,
        "pool_size": POOL_SIZE,
        "max_overflow": POOL_OVERFLOW,
    }
    if parsed.get_backend_name() == "sqlite":
        return sqlite.open_engine(parsed, file, common, foreign_keys=foreign_keys)
    if parsed.get_backend_name() != "postgresql":
        raise ConfigurationError(
            "KINEDEX_DATABASE_URL: Kinedex knows SQLite and PostgreSQL, not "
            f"{parsed.get_backend_name()}"
        )
    try:
        return postgresql.open_engine(parsed, common, options)
    except (ArgumentError, ImportError) as error:
        raise ConfigurationError(
            f"KINEDEX_DATABASE_URL: there is no driver for {parsed.drivername} databases: install "
            "`kinedex[postgres]`"
        ) from error


def _to_json(value: object) -> str:
    # JSON has no NaN: other programs could not read such a column.
    text = json.dumps(value, allow_nan=False, ensure_ascii=False)
    if _NUL in text:
        text = json.dumps(without_nul(value), allow_nan=False, ensure_ascii=False)
    return text


_NUL = "\\u0000"
"""A NUL as JSON writes it; also a backslash before the letters `u0000`, which stays as it is."""


def without_nul(value: Any) -> Any:
    """The value with U+FFFD for each NUL: PostgreSQL cannot read a text that has one.

    Only what a file says can hold a NUL, such as the name of a joint: texts of clients are refused.
    """
    if isinstance(value, str):
        return value.replace("\0", "\N{REPLACEMENT CHARACTER}")
    if isinstance(value, dict):
        return {without_nul(key): without_nul(item) for key, item in value.items()}
    return [without_nul(item) for item in value] if isinstance(value, list | tuple) else value
