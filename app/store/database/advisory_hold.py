"""A hold on removals (`files.removal_hold`) for files that several machines share: a lock of
PostgreSQL, which the server releases when the connection ends."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from sqlalchemy import text

from app.store.database.engine import Database

HOLD = 0x6B696E66
"""Number of an advisory lock; `postgresql.WRITER_LOCK` is another one."""
_SESSION = {"isolation_level": "AUTOCOMMIT"}
_TAKE = text(f"SELECT pg_advisory_lock_shared({HOLD})")
_RELEASE = text(f"SELECT pg_advisory_unlock_shared({HOLD})")
_TRY = text(f"SELECT pg_try_advisory_xact_lock({HOLD})")


class AdvisoryHold:
    """The hold on the removals of the files of one database, by any number of machines."""

    def __init__(self, database: Database) -> None:
        self._database = database

    @contextmanager
    def held(self) -> Iterator[None]:
        """Within the block, no process removes a file. Waits for removals that have begun."""
        # Without a transaction: an idle one would keep the server from cleaning its tables.
        with self._database.engine.connect().execution_options(**_SESSION) as connection:
            connection.execute(_TAKE)
            try:
                yield
            finally:
                connection.execute(_RELEASE)

    @contextmanager
    def free(self) -> Iterator[bool]:
        """Whether files may be removed within the block: no process holds them."""
        with self._database.write_row() as tx:
            yield bool(tx.execute(_TRY).scalar_one())
