"""Tidying the folder of files: when the worker begins, and every hour."""

from __future__ import annotations

import threading

from app.store.store import Store
from app.store.upkeep.sweep import SweepReport, try_to_sweep

EVERY_S = 3600.0


class Sweeps:
    """Sweeps a store in a thread of its own: a large library takes seconds, heartbeats go on."""

    def __init__(self, store: Store, retention_days: float) -> None:
        self._store = store
        self._retention_days = retention_days
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._sweep_hourly, name="sweep", daemon=True)

    def begin(self) -> SweepReport:
        """Sweep now, and from now on every hour; what this sweep did."""
        swept = try_to_sweep(self._store, self._retention_days)
        self._thread.start()
        return swept

    def end(self) -> None:
        """Sweep no more; returns when the thread has ended."""
        self._stop.set()
        if self._thread.is_alive():
            self._thread.join()

    def _sweep_hourly(self) -> None:
        while not self._stop.wait(EVERY_S):
            try_to_sweep(self._store, self._retention_days)
