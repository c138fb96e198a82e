"""The captions of clips: one row for each sentence of each clip."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from sqlalchemy import bindparam, delete, insert, select

from app.store.database.engine import Tx
from app.store.database.tables import clip_captions
from app.store.database.text_list import as_list, is_one_of

_ADD = insert(clip_captions)
_REMOVE = delete(clip_captions).where(clip_captions.c.clip_id == bindparam("the_id"))
_OF_CLIPS = (
    select(clip_captions.c.clip_id, clip_captions.c.text)
    .where(is_one_of(clip_captions.c.clip_id, "ids"))
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
    found: dict[str, list[str]] = {}
    for clip_id, text in tx.execute(_OF_CLIPS, {"ids": as_list(clip_ids)}):
        found.setdefault(clip_id, []).append(text)
    return {clip_id: tuple(texts) for clip_id, texts in found.items()}
