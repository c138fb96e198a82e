"""Delivers events to webhooks, in threads, while the worker does other things."""

from __future__ import annotations

import logging
import threading
from concurrent.futures import ThreadPoolExecutor

from app.errors import StorageError
from app.services.webhooks.sending import send
from app.store.database.ids import utc_now
from app.store.store import Store
from app.store.webhooks import deliveries
from app.store.webhooks.deliveries import Delivery

_log = logging.getLogger(__name__)

LOOK_SECONDS = 1.0
"""Between two looks at what is due, while nothing is."""
AT_ONCE = 8
"""Webhooks that receive an event at the same time."""
STORE_PAUSE_SECONDS = 5.0
"""Before the store is tried again after it failed."""


class Deliveries:
    """A thread that delivers events. Several workers share the events of a library."""

    def __init__(self, store: Store) -> None:
        self._store = store
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="webhooks", daemon=True)

    def begin(self) -> None:
        """Start the thread."""
        self._thread.start()

    def end(self) -> None:
        """Deliver no more. Returns when the calls in hand have ended."""
        self._stop.set()
        if self._thread.is_alive():
            self._thread.join()

    def _run(self) -> None:
        with ThreadPoolExecutor(AT_ONCE, thread_name_prefix="webhook") as threads:
            while not self._stop.is_set():
                try:
                    due = self._take()
                except StorageError as problem:
                    _log.warning("webhooks must wait: %s", problem.detail)
                    self._stop.wait(STORE_PAUSE_SECONDS)
                    continue
                list(threads.map(self._deliver, due))
                if not due:
                    self._stop.wait(LOOK_SECONDS)

    def _take(self) -> tuple[Delivery, ...]:
        with self._store.read() as tx:  # only a write waits for the disk
            if not deliveries.is_any_due(tx):
                return ()
        with self._store.write() as tx:
            return deliveries.take_due(tx, AT_ONCE)

    def _deliver(self, delivery: Delivery) -> None:
        outcome = send(delivery, utc_now())
        if not outcome.is_delivered:
            _log.info("webhook %s failed: %s", delivery.webhook_id, outcome.detail)
        try:
            with self._store.write() as tx:
                deliveries.settle(tx, delivery, outcome)
        except StorageError as problem:
            # The delivery is due again after TAKEN_SECONDS.
            _log.warning("the outcome of a webhook was not stored: %s", problem.detail)
