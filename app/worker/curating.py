"""Compares new clips with all others in the background, so that duplicates are known."""

from __future__ import annotations

import logging
import threading

from app.kinedex_error import KinedexError
from app.services.curation import comparison
from app.services.library.library import Library

CHECK_INTERVAL_S = 2.0
_log = logging.getLogger(__name__)


class Curating:
    """Compares clips in its own thread, while no clip waits for its analysis.

    The heartbeats of the worker go on meanwhile.
    """

    def __init__(self, lib: Library) -> None:
        self._lib = lib
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._compare, name="curate", daemon=True)

    def begin(self) -> None:
        """Begin to compare."""
        self._thread.start()

    def end(self) -> None:
        """Stop comparing; returns when the thread has ended."""
        self._stop.set()
        if self._thread.is_alive():
            self._thread.join()

    def _compare(self) -> None:
        while not self._stop.wait(CHECK_INTERVAL_S):
            try:
                if comparison.is_due(self._lib):
                    self._compare_some()
            except KinedexError:
                _log.exception("clips could not be compared; trying again")

    def _compare_some(self) -> None:
        for _ in comparison.compare_pending(self._lib):
            if self._stop.is_set():
                return
