"""Sweeps the folder of files when the worker begins, and then one worker of all every hour."""

from __future__ import annotations

import logging
import threading
from datetime import timedelta

from app.errors import StorageError
from app.store.jobs import periodic
from app.store.jobs.periodic import PeriodicTask
from app.store.store import Store
from app.store.upkeep.sweep import SweepReport, try_to_sweep

_log = logging.getLogger(__name__)

SWEEP_INTERVAL_S = 3600.0
LOOK_INTERVAL_S = 60.0
"""Time between two looks whether a sweep is due: another worker may have done it."""


class Sweeps:
    """Sweeps a store in its own thread, because a large library takes seconds.

    The heartbeats of the worker go on meanwhile.
    """

    def __init__(self, store: Store, retention_days: float) -> None:
        self._store = store
        self._retention_days = retention_days
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._sweep_hourly, name="sweep", daemon=True)

    def begin(self) -> SweepReport:
        """Sweep now, and in the background when it is due; returns the report of this sweep."""
        self._take_turn()
        swept = try_to_sweep(self._store, self._retention_days)
        self._thread.start()
        return swept

    def end(self) -> None:
        """Stop sweeping; returns when the thread has ended."""
        self._stop.set()
        if self._thread.is_alive():
            self._thread.join()

    def _sweep_hourly(self) -> None:
        while not self._stop.wait(LOOK_INTERVAL_S):
            if self._take_turn():
                try_to_sweep(self._store, self._retention_days)

    def _take_turn(self) -> bool:
        interval = timedelta(seconds=SWEEP_INTERVAL_S)
        try:
            with self._store.read() as tx:  # only a write waits for other writers
                if not periodic.is_due(tx, PeriodicTask.SWEEP, interval):
                    return False
            with self._store.database.write() as tx:
                return periodic.take_turn(tx, PeriodicTask.SWEEP, interval)
        except StorageError as problem:
            _log.warning("the turn to sweep could not be taken: %s", problem.detail)
            return False
