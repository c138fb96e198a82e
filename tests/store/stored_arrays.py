"""The arrays that the store has of a clip."""

from __future__ import annotations

from sqlalchemy import select

from app.store.database.engine import Tx
from app.store.database.tables import clip_arrays


def array_versions(tx: Tx, clip_id: str) -> dict[str, int]:
    """The analysis version of each of a clip's arrays, by name."""
    query = select(clip_arrays.c.name, clip_arrays.c.version)
    rows = tx.execute(query.where(clip_arrays.c.clip_id == clip_id))
    return {name: version for name, version in rows}  # noqa: C416 - rows to a dict
