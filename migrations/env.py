"""Alembic's entry: runs on the connection that `app.store.database.schema` hands over."""

from __future__ import annotations

from typing import Any, Literal

from alembic import context

from app.store.database.tables import UtcDateTime, metadata


def render_item(kind: str, item: Any, _context: Any) -> str | Literal[False]:
    """Writes plain types into migrations: they must not change when the code does."""
    if kind == "type" and isinstance(item, UtcDateTime):
        return "sa.DateTime(timezone=True)"
    return False


# Batch mode: SQLite changes a table by rebuilding it. The caller's transaction holds the whole
# upgrade, so that a killed one leaves the old schema.
context.configure(
    connection=context.config.attributes["connection"],
    target_metadata=metadata,
    render_as_batch=True,
    compare_type=True,
    render_item=render_item,
)
with context.begin_transaction():
    context.run_migrations()
