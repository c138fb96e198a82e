"""PostgreSQL: how a database is opened, how its transactions run, and what its errors mean.

Readers see one snapshot (REPEATABLE READ, READ ONLY). Of the writers, one runs at a time, as with
SQLite: each begins by taking an advisory lock, which ends with its transaction. So the rules of
the store hold without another look: what a transaction has read does not change before it
commits, no two wait for each other (a deadlock), and none must be repeated because of another one
(a serialization failure). Nearly all writers raise the library's version, a single row, so they
would wait for each other anyway. A heartbeat changes one row of its own and does not wait.

A server ends the transaction of a process that hangs, so that it does not keep the lock.
"""

from __future__ import annotations

from typing import Any

from sqlalchemy import Connection, Engine, create_engine, event, text
from sqlalchemy.engine import URL

from app.errors import DatabaseDamaged, DiskFull, StorageError
from app.store.database.access import LOCK_TIMEOUT_S, Access, ServerOptions, access_of

NAMES = frozenset({"postgresql", "postgres"})
"""Schemes of URLs that mean PostgreSQL."""
DRIVER = "postgresql+psycopg"
CONNECT_TIMEOUT_S = 10
HUNG_WRITER_S = 60.0
"""Seconds after which the server ends a write transaction whose process sends nothing."""
WRITER_LOCK = 0x6B696E65
"""Number of an advisory lock ("kine"); any number that nobody else uses."""
POOL_SIZE = 8
"""Connections that stay open."""

# A peer that vanished is noticed within a minute: the operating system would take two hours.
_KEEPALIVE = {"keepalives_idle": 30, "keepalives_interval": 10, "keepalives_count": 3}

_BEGIN = {
    Access.READ: "SET TRANSACTION ISOLATION LEVEL REPEATABLE READ, READ ONLY",
    Access.WRITE: (
        "SELECT set_config('idle_in_transaction_session_timeout',"
        f" '{round(1000 * HUNG_WRITER_S)}', true), pg_advisory_xact_lock({WRITER_LOCK})"
    ),
}
# The transaction's first query may be streamed, and then its options are the connection's.
_AT_ONCE = {"stream_results": False, "yield_per": None}
_DISK_FULL, _LOCKED, _CANCELED = "53100", "55P03", "57014"
_DAMAGED = ("XX001", "XX002")
_NOT_ALLOWED = "42501"
_UNUSABLE_CLASSES = ("08", "28", "3D", "53", "57", "58")
"""Classes of SQLSTATE: connection, authorization, no such database, resources, operator, system."""
_ENDED_BY_SERVER = ("25P03", "25P04", "25006", "40001", "40P01")
"""The server ended the transaction: a timeout, a server that only reads, or another transaction."""
_COLLATED = """
SELECT table_name, column_name FROM information_schema.columns
WHERE table_schema = current_schema() AND data_type IN ('character varying', 'text')
AND collation_name IS DISTINCT FROM 'C' ORDER BY table_name, column_name
"""


def with_driver(url: URL) -> URL:
    """The URL with our driver, if it names PostgreSQL without one."""
    return url.set(drivername=DRIVER) if url.drivername in NAMES else url


def open_engine(url: URL, common: dict[str, Any], options: ServerOptions) -> Engine:
    """An engine for the database; common: arguments of `create_engine`. Raises ImportError."""
    limits = {
        "lock_timeout": LOCK_TIMEOUT_S,
        "statement_timeout": options.statement_timeout_s,
    }
    settings = " ".join(f"-c {name}={round(1000 * s)}" for name, s in limits.items())
    asked = url.query.get("options", "")
    arguments: dict[str, Any] = {
        "connect_timeout": CONNECT_TIMEOUT_S,
        "application_name": "kinedex",
        **_KEEPALIVE,
        **url.query,
        # What the URL asks for comes last, and so it is what counts.
        "options": f"{settings} {asked if isinstance(asked, str) else ' '.join(asked)}".strip(),
    }
    pool_size = min(POOL_SIZE, options.connections)
    engine = create_engine(
        url.difference_update_query(["options"]),
        connect_args=arguments,
        pool_pre_ping=True,
        **common | {"pool_size": pool_size, "max_overflow": options.connections - pool_size},
    )

    @event.listens_for(engine, "begin")
    def _begin(connection: Connection) -> None:
        statement = _BEGIN.get(access_of(connection) or Access.WRITE_ROW)
        if statement is not None:
            connection.exec_driver_sql(statement, execution_options=_AT_ONCE)

    return engine


def failure_of(error: BaseException | None) -> StorageError | None:
    """What an error of psycopg means; None if it is no failure of the store."""
    state = getattr(error, "sqlstate", None)
    if state == _DISK_FULL:
        return DiskFull()
    if state in _DAMAGED:
        return DatabaseDamaged(f"The database is damaged: {_message(error)}")
    if state == _LOCKED:
        return StorageError("The database stayed locked by another writer")
    if state == _CANCELED:
        return StorageError("The database stopped a statement, because it took too long")
    if state in (_NOT_ALLOWED, *_ENDED_BY_SERVER) or (state or "")[:2] in _UNUSABLE_CLASSES:
        return StorageError(f"The database cannot be used: {_message(error)}")
    # psycopg names no state if there is no connection, or none any more.
    if state is None and type(error).__name__ in ("OperationalError", "ConnectionTimeout"):
        return StorageError(f"The database cannot be used: {_message(error)}")
    return None


def lift_time_limits(tx: Connection) -> None:
    """Lets the rest of the transaction take any time, as a migration or a copy may."""
    for name in ("statement_timeout", "idle_in_transaction_session_timeout"):
        tx.exec_driver_sql(f"SET LOCAL {name} = 0")


def collate(tx: Connection) -> None:
    """Makes all text columns compare by code points, as SQLite does.

    Lists are sorted by the database and continue after a text that Python has seen, so the order
    must not depend on the language for which the database was made. A migration need not know
    this: each upgrade ends with this call.
    """
    quote = tx.dialect.identifier_preparer.quote
    columns: dict[str, list[str]] = {}
    for table, column in tx.execute(text(_COLLATED)):
        columns.setdefault(table, []).append(f'ALTER {quote(column)} TYPE VARCHAR COLLATE "C"')
    for table, changes in columns.items():
        tx.exec_driver_sql(f"ALTER TABLE {quote(table)} {', '.join(changes)}")


def _message(error: BaseException | None) -> str:
    """The first line of the message: the others may quote a row."""
    return (str(error).splitlines() or ["no reason given"])[0]
