"""The audit log of a library: list it, and forget its old rows."""

from __future__ import annotations

from datetime import timedelta

from app.services.library.library import Library
from app.store import audit as stored
from app.store.audit import AuditFilter, AuditRecord
from app.store.database.ids import utc_now
from app.store.database.paging import Page

ROWS_A_ROUND = 5_000
"""Old rows that one transaction removes: other writers must not wait long."""


def list_audit(
    lib: Library, filter: AuditFilter, limit: int = 50, cursor: str | None = None
) -> Page[AuditRecord]:
    """One page of the log, newest first. Raises BadField for a bad cursor."""
    with lib.store.read() as tx:
        page = stored.list_page(tx, filter, limit=limit, cursor=cursor)
        return page.counted(stored.total(tx, filter))


def remove_old_rows(lib: Library) -> int:
    """Remove some of the rows older than `audit_retention_days`; returns how many.

    Call it from time to time. It removes only a few, as `jobs.remove_old_jobs` does.
    """
    days = lib.settings.audit_retention_days
    if not days:
        return 0
    end = utc_now() - timedelta(days=days)
    with lib.store.read() as tx:  # only a write waits for other writers
        if not stored.is_any_before(tx, end):
            return 0
    with lib.store.write() as tx:
        return stored.remove_before(tx, end, ROWS_A_ROUND)
