"""Clips that look wrong within their label, and that a person has said are right."""

from __future__ import annotations

from sqlalchemy import delete, insert, select

from app.store.database.engine import Tx
from app.store.database.ids import utc_now
from app.store.database.tables import dismissed_outliers as table


def add(tx: Tx, clip_id: str, reason: str, label: str) -> None:
    """No list shows the clip for this reason while it has this label."""
    same = (table.c.clip_id == clip_id, table.c.reason == reason)
    tx.execute(delete(table).where(*same))
    tx.execute(
        insert(table).values(clip_id=clip_id, reason=reason, label=label, dismissed_at=utc_now())
    )


def every(tx: Tx) -> set[tuple[str, str, str]]:
    """Clip, reason and label of all that were dismissed."""
    rows = tx.execute(select(table.c.clip_id, table.c.reason, table.c.label))
    return {(row.clip_id, row.reason, row.label) for row in rows}
