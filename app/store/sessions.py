"""Who is signed in with a browser: a random token in a cookie stands for an API key.

The key itself never reaches the cookie: browsers send a cookie to every port of a machine. A
session is a row with the hash of its token and the public id of its key, so that nobody can use
what is stored. All processes of the API share the rows, in the table's own file with SQLite (see
`shared_rows`), so that any of them can answer the next call.
"""

from __future__ import annotations

import hashlib
import logging
import secrets
import sqlite3
import time
from collections.abc import Callable
from threading import Lock
from typing import TypeVar

from sqlalchemy import Connection, Engine, text
from sqlalchemy.exc import DBAPIError

from app.errors import StorageError
from app.store.shared_rows import make_table

_log = logging.getLogger(__name__)
_Result = TypeVar("_Result")

MAX_SESSIONS = 1000
"""Then the session that was not used for the longest time ends."""
MAX_IDLE_SECONDS = 12 * 3600.0
NOTE_SECONDS = 60.0
"""The last use of a session is stored at most once in this time."""
TOKEN_BYTES = 32

_TABLE = (
    "browser_sessions (token_sha256 VARCHAR PRIMARY KEY, key_id VARCHAR NOT NULL,"
    " used_at DOUBLE PRECISION NOT NULL)"
)
_ADD = text("INSERT INTO browser_sessions VALUES (:token, :key_id, :now)")
_END_OLD = text("DELETE FROM browser_sessions WHERE used_at < :oldest")
_END_MOST = text(
    "DELETE FROM browser_sessions WHERE token_sha256 NOT IN (SELECT token_sha256"
    " FROM browser_sessions ORDER BY used_at DESC, token_sha256 LIMIT :most)"
)
_GET = text("SELECT key_id, used_at FROM browser_sessions WHERE token_sha256 = :token")
_USE = text("UPDATE browser_sessions SET used_at = :now WHERE token_sha256 = :token")
_END = text("DELETE FROM browser_sessions WHERE token_sha256 = :token")


class Sessions:
    """Ids of API keys by the tokens of their sessions; threads and processes share them.

    clock: seconds, the same in all processes.
    """

    def __init__(self, engine: Engine, clock: Callable[[], float] = time.time) -> None:
        """engine: of `shared_rows.open_engine`."""
        self._engine = engine
        self._clock = clock
        self._lock = Lock()
        self._is_made = False

    def begin(self, key_id: str) -> str:
        """A new token for a key that was checked. Raises StorageError."""
        token, now = secrets.token_urlsafe(TOKEN_BYTES), self._clock()

        def begin(connection: Connection) -> None:
            connection.execute(_ADD, {"token": _digest(token), "key_id": key_id, "now": now})
            connection.execute(_END_OLD, {"oldest": now - MAX_IDLE_SECONDS})
            connection.execute(_END_MOST, {"most": MAX_SESSIONS})

        self._execute(begin)
        return token

    def key_of(self, token: str) -> str:
        """The id of a session's key, which may have been revoked since; empty if there is none.

        A session that cannot be read counts as none.
        """
        if not token:
            return ""
        named, now = {"token": _digest(token)}, self._clock()

        def use(connection: Connection) -> str:
            row = connection.execute(_GET, named).one_or_none()
            if row is None or now - row.used_at > MAX_IDLE_SECONDS:
                return ""
            if now - row.used_at >= NOTE_SECONDS:
                connection.execute(_USE, {**named, "now": now})
            return str(row.key_id)

        try:
            return self._execute(use)
        except StorageError:
            return ""

    def end(self, token: str) -> None:
        """The token stands for nothing from now on. Raises StorageError."""
        self._execute(lambda connection: connection.execute(_END, {"token": _digest(token)}))

    def close(self) -> None:
        """Close the connections."""
        self._engine.dispose()

    def _execute(self, work: Callable[[Connection], _Result]) -> _Result:
        try:
            with self._engine.connect() as connection:
                with self._lock:
                    if not self._is_made:
                        make_table(connection, _TABLE)
                        self._is_made = True
                return work(connection)
        except (DBAPIError, sqlite3.Error) as problem:
            _log.warning("the sessions of browsers cannot be used (%s)", problem)
            raise StorageError("Nobody can sign in or out now.") from problem


def _digest(token: str) -> str:
    return hashlib.sha256(token.encode("utf-8", "surrogatepass")).hexdigest()
