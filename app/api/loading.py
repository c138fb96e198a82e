"""Loads the index in the background while the service answers calls, and keeps it loaded."""

from __future__ import annotations

import gc
import logging
import threading

from app.errors import StorageError
from app.services.children.processes import import_libraries
from app.services.find.warming import Warmth
from app.services.library.library import Library

log = logging.getLogger(__name__)

RETRY_SECONDS = 2.0
FOLLOW_SECONDS = 0.5
"""Time between two looks at what has changed."""


class Loading:
    """A thread that loads the index of a library, does the first work, and follows changes.

    After a failure to load the index, it tries again.
    """

    def __init__(self, library: Library) -> None:
        self._library = library
        self._warmth = Warmth(library)
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="load-index", daemon=True)

    @property
    def is_warm(self) -> bool:
        """Whether the first search of each kind is as fast as later ones."""
        return self._warmth.is_warm

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def stop(self) -> None:
        """Stop trying. Returns when the thread has ended."""
        self._stop.set()
        self._thread.join()

    def _run(self) -> None:
        self._load()
        try:
            self._warmth.warm(self._stop.is_set)
        except Exception:
            # The searches themselves do the first work then.
            log.exception("the first searches could not be prepared")
        # The collector need not look again at what stays: indexes, models, code.
        gc.collect()
        gc.freeze()
        while not self._stop.wait(FOLLOW_SECONDS):
            self._follow()

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

    def _follow(self) -> None:
        try:
            self._warmth.follow()
        except StorageError:
            self._stop.wait(RETRY_SECONDS)  # `/readyz` tells what is wrong
        except Exception:
            log.exception("changes could not be loaded before a search; trying again")
            self._stop.wait(RETRY_SECONDS)
