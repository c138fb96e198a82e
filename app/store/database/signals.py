"""Signals between processes: what waits for a change need not look for it again and again.

With PostgreSQL, the transaction that makes the change sends the signal (NOTIFY), and it arrives
when that transaction commits. A signal can be lost when a connection breaks, so whoever waits also
looks from time to time. SQLite has no signals: there one only looks.
"""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Collection
from enum import StrEnum
from typing import TYPE_CHECKING, Any

from sqlalchemy import bindparam, func, select

from app.store.database.engine import Database, Tx

if TYPE_CHECKING:
    from psycopg import Connection

_log = logging.getLogger(__name__)

RECONNECT_S = 5.0
"""Time before another attempt to listen."""
LOOK_S = 0.5
"""How often the thread that listens looks whether it should end."""


class Signal(StrEnum):
    """What has happened."""

    QUEUE = "kinedex_queue"
    """A job can be claimed."""
    LIBRARY = "kinedex_library"
    """The library has another version."""


_SEND = select(func.pg_notify(bindparam("channel"), ""))


def send(tx: Tx, signal: Signal) -> None:
    """Sends a signal when the transaction commits; several of one kind count as one."""
    if tx.dialect.name == "postgresql":
        tx.execute(_SEND, {"channel": signal.value})


class Listener:
    """Calls a function at each signal of some kinds, in a thread of its own."""

    def __init__(
        self, database: Database, signals: Collection[Signal], on_signal: Callable[[], object]
    ) -> None:
        """It listens from `begin` on, if the database has signals.

        The function is also called when a connection is made, since signals before it were lost.
        """
        self._database, self._signals, self._on_signal = database, tuple(signals), on_signal
        self._stop = threading.Event()
        self._is_listening = threading.Event()
        self._thread = threading.Thread(target=self._run, name="signals", daemon=True)

    @property
    def is_listening(self) -> bool:
        """Whether signals arrive now. While they do not, one must look more often."""
        return self._is_listening.is_set()

    def begin(self) -> None:
        """Start to listen, if the database has signals."""
        if not self._database.is_sqlite:
            self._thread.start()

    def end(self) -> None:
        """Stop listening. Returns when the thread has ended."""
        self._stop.set()
        if self._thread.is_alive():
            self._thread.join()

    def _run(self) -> None:
        while not self._stop.is_set():
            try:
                self._listen()
            except Exception as problem:  # noqa: BLE001 - psycopg is no dependency without a server
                _log.warning("signals of the database do not arrive: %s", type(problem).__name__)
            self._is_listening.clear()
            self._stop.wait(RECONNECT_S)

    def _listen(self) -> None:
        """Listen until `end` is called. Raises what psycopg and SQLAlchemy raise."""
        pooled = self._database.engine.raw_connection()
        connection: Any = pooled.driver_connection
        pooled.detach()  # it stays in use: the pool need not keep a place for it
        try:
            self._receive(connection)
        finally:
            connection.close()

    def _receive(self, connection: Connection[Any]) -> None:
        connection.rollback()
        connection.autocommit = True
        for signal in self._signals:
            connection.execute(f"LISTEN {signal.value}")
        self._is_listening.set()
        self._on_signal()
        while not self._stop.is_set():
            for _ in connection.notifies(timeout=LOOK_S, stop_after=1):
                self._on_signal()
