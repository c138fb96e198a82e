"""The captions of clips: one row for each sentence of each clip."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from sqlalchemy import bindparam, delete, insert, select

from app.store.database.engine import Tx
from app.store.database.tables import clip_captions

IDS_PER_QUERY = 500
"""A limit, because databases limit the number of parameters of one statement."""

_ADD = insert(clip_captions)
_REMOVE = delete(clip_captions).where(clip_captions.c.clip_id == bindparam("the_id"))
_OF_CLIPS = (
    select(clip_captions.c.clip_id, clip_captions.c.text)
    .where(clip_captions.c.clip_id.in_(bindparam("ids", expanding=True)))
    .order_by(clip_captions.c.clip_id, clip_captions.c.position)
)


def put(tx: Tx, clip_id: str, captions: Sequence[str]) -> None:
    """Replace the captions of a clip."""
    tx.execute(_REMOVE, {"the_id": clip_id})
    add(tx, clip_id, captions)


def add(tx: Tx, clip_id: str, captions: Sequence[str]) -> None:
    """Add the captions of a clip that has none."""
    rows = [
        {"clip_id": clip_id, "position": position, "text": text}
        for position, text in enumerate(dict.fromkeys(captions))
    ]
    if rows:
        tx.execute(_ADD, rows)


def get_many(tx: Tx, clip_ids: Collection[str]) -> dict[str, tuple[str, ...]]:
    """Captions by clip id, in the client's order; clips without captions are left out."""
    ids, found = list(clip_ids), dict[str, list[str]]()
    for first in range(0, len(ids), IDS_PER_QUERY):
        batch = ids[first : first + IDS_PER_QUERY]
        for clip_id, text in tx.execute(_OF_CLIPS, {"ids": batch}):
            found.setdefault(clip_id, []).append(text)
    return {clip_id: tuple(texts) for clip_id, texts in found.items()}
