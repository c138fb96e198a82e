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
        self._settled = -1
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
                self._compare_if_due()
            except KinedexError:
                _log.exception("clips could not be compared; trying again")

    def _compare_if_due(self) -> None:
        version = comparison.unchanged_version(self._lib)
        if version == self._settled:
            return
        # Looking for clips that wait reads all of them, so it is done once for each version.
        if not comparison.is_any_waiting(self._lib):
            self._settled = version
        elif not comparison.is_analyzing(self._lib):
            self._compare_some()

    def _compare_some(self) -> None:
        for _ in comparison.compare_pending(self._lib):
            if self._stop.is_set():
                return
