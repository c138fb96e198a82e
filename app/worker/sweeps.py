"""Sweeps the folder of files when the worker begins, and then every hour."""

from __future__ import annotations

import threading

from app.store.store import Store
from app.store.upkeep.sweep import SweepReport, try_to_sweep

SWEEP_INTERVAL_S = 3600.0


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
        """Sweep now, and then every hour in the background; returns the report of this sweep."""
        swept = try_to_sweep(self._store, self._retention_days)
        self._thread.start()
        return swept

    def end(self) -> None:
        """Stop sweeping; returns when the thread has ended."""
        self._stop.set()
        if self._thread.is_alive():
            self._thread.join()

    def _sweep_hourly(self) -> None:
        while not self._stop.wait(SWEEP_INTERVAL_S):
            try_to_sweep(self._store, self._retention_days)
