"""Loads the index in the background while the service already answers calls."""

from __future__ import annotations

import logging
import threading

from app.services.children.processes import import_libraries
from app.services.library.library import Library

log = logging.getLogger(__name__)

RETRY_SECONDS = 2.0


class Loading:
    """A thread that loads the index of a library. After a failure it tries again."""

    def __init__(self, library: Library) -> None:
        self._library = library
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._load, name="load-index", daemon=True)

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def stop(self) -> None:
        """Stop trying. Returns when the thread has ended."""
        self._stop.set()
        self._thread.join()

    def _load(self) -> None:
        while not self._stop.is_set():
            try:
                import_libraries()
                self._library.index.catch_up(self._library.store)
            except Exception:
                # Any failure may be temporary (a locked database, a full disk): try again.
                log.exception("the index could not be loaded; trying again")
                self._stop.wait(RETRY_SECONDS)
            else:
                return
