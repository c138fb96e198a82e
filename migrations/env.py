"""The script that Alembic runs, on the connection from `app.store.database.schema`."""

from __future__ import annotations

from typing import Any, Literal

from alembic import context

from app.store.database import collection_tables, service_tables, tables
from app.store.database.columns import UtcDateTime

# Both modules add their tables to the same collection.
(metadata,) = {tables.metadata, service_tables.metadata, collection_tables.metadata}


def render_item(kind: str, item: Any, _context: Any) -> str | Literal[False]:
    """Writes plain types into migrations, which must not change when the code changes."""
    if kind == "type" and isinstance(item, UtcDateTime):
        return "sa.DateTime(timezone=True)"
    return False


# Batch mode, because SQLite changes a table by rebuilding it. The whole upgrade is in the caller's
# transaction, so that the old schema stays if the process is killed.
context.configure(
    connection=context.config.attributes["connection"],
    target_metadata=metadata,
    render_as_batch=True,
    compare_type=True,
    render_item=render_item,
)
with context.begin_transaction():
    context.run_migrations()
