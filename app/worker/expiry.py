"""Removing jobs that ended long ago, a few at a time, while the worker does other things; and
what deletions left in the database's log."""

from __future__ import annotations

import logging
import time

from app.services.clips import jobs
from app.services.library.library import Library

_log = logging.getLogger(__name__)

ROUND_S = 60.0
"""Between two rounds."""


class Expiry:
    """When a worker last removed old jobs."""

    def __init__(self, lib: Library) -> None:
        self._lib = lib
        self._next = time.monotonic()

    def remove_if_due(self) -> None:
        """A round, if it is time for one; what it removes is logged. Raises StorageError.

        After it, what was deleted before is in no file of the database, unless somebody reads.
        """
        if time.monotonic() < self._next:
            return
        self._next = time.monotonic() + ROUND_S
        removed = jobs.remove_old_jobs(self._lib)
        if removed:
            days = self._lib.settings.job_retention_days
            _log.info("removed %d jobs that ended over %d days ago", removed, days)
        # Without waiting, since heartbeats must go on: the next round tries again.
        self._lib.store.erase_traces(wait_s=0.0)
