"""The measures of quality and movement of clips: see `measures.QUALITY`."""

from __future__ import annotations

from collections.abc import Mapping

from sqlalchemy import bindparam, delete, insert, select

from app.store.clips.measures import QUALITY
from app.store.database.engine import Tx
from app.store.database.tables import clip_measures

Values = Mapping[str, float | None]
"""Values by the names of QUALITY; None for a measure that a clip does not have."""

_DELETE = delete(clip_measures).where(clip_measures.c.clip_id == bindparam("the_id"))
_ADD = insert(clip_measures)
_ONE = select(*(clip_measures.c[name] for name in QUALITY)).where(
    clip_measures.c.clip_id == bindparam("the_id")
)


def put(tx: Tx, clip_id: str, values: Values) -> None:
    """Store the measures of a clip; they replace the earlier ones."""
    tx.execute(_DELETE, {"the_id": clip_id})
    tx.execute(_ADD, {"clip_id": clip_id, **{name: values.get(name) for name in QUALITY}})


def get(tx: Tx, clip_id: str) -> Values:
    """The measures of a clip; all None before the analysis that finds them."""
    row = tx.execute(_ONE, {"the_id": clip_id}).one_or_none()
    return dict.fromkeys(QUALITY) if row is None else dict(zip(QUALITY, row, strict=True))
