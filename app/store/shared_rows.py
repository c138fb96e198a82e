"""Small tables that the processes of a library share, and that need not survive a crash.

With SQLite they are in a file of their own, without syncs: a write costs a tenth of a millisecond.
A commit to the library's database costs several, and it would wait for other writers. With
PostgreSQL they are unlogged tables. No migration makes them: whoever uses one makes it.
"""

from __future__ import annotations

import os
import sqlite3
from contextlib import suppress
from pathlib import Path

from sqlalchemy import Connection, Engine, create_engine, event, text
from sqlalchemy.engine import URL

FILE_NAME = "limits.sqlite3"
BUSY_TIMEOUT_S = 1.0


def open_engine(library: Engine, folder: Path) -> Engine:
    """The database of the small tables. library: its own database; folder: for the file."""
    if library.dialect.name != "sqlite":
        return library.execution_options(isolation_level="AUTOCOMMIT")
    file = folder / FILE_NAME
    with suppress(OSError):  # a folder that cannot be written to has no tables
        os.close(os.open(file, os.O_CREAT | os.O_RDWR, 0o600))  # it has addresses of clients
    url = URL.create("sqlite", database=str(file))
    engine = create_engine(
        url,
        connect_args={"timeout": BUSY_TIMEOUT_S, "isolation_level": None},
        pool_reset_on_return=None,
        skip_autocommit_rollback=True,
        isolation_level="AUTOCOMMIT",
    )

    @event.listens_for(engine, "connect")
    def _prepare(connection: sqlite3.Connection, _record: object) -> None:
        connection.execute("PRAGMA synchronous = OFF")
        connection.execute("PRAGMA journal_mode = WAL")

    return engine


def make_table(connection: Connection, table: str) -> None:
    """Make a table, unless it is there. table: its name and its columns, in SQL."""
    kind = "TABLE" if connection.dialect.name == "sqlite" else "UNLOGGED TABLE"
    connection.execute(text(f"CREATE {kind} IF NOT EXISTS {table}"))
