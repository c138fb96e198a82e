"""Removes jobs that ended long ago and old rows of the audit log, a few at a time.

It also removes deleted data from the log of the database.
"""

from __future__ import annotations

import logging
import time

from app.services.clips import jobs
from app.services.library import audit
from app.services.library.library import Library

_log = logging.getLogger(__name__)

ROUND_INTERVAL_S = 60.0
"""Time between two rounds."""


class Expiry:
    """Removes the old jobs and rows of the audit log of a library, in rounds."""

    def __init__(self, lib: Library) -> None:
        self._lib = lib
        self._next = time.monotonic()

    def remove_if_due(self) -> None:
        """Do a round if it is due, and log what was removed. Raises StorageError.

        After a round no file of the database holds deleted data, unless a reader was active.
        """
        if time.monotonic() < self._next:
            return
        self._next = time.monotonic() + ROUND_INTERVAL_S
        removed = jobs.remove_old_jobs(self._lib)
        if removed:
            days = self._lib.settings.job_retention_days
            _log.info("removed %d jobs that ended over %d days ago", removed, days)
        old = audit.remove_old_rows(self._lib)
        if old:
            days = self._lib.settings.audit_retention_days
            _log.info("removed %d rows of the audit log older than %d days", old, days)
        # It does not wait for readers, because heartbeats must go on. The next round tries again.
        self._lib.store.erase_traces(wait_s=0.0)
