"""The texts of clips that may name a person: read and written for all clips of a library."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

from sqlalchemy import bindparam, case, delete, select, update

from app.store.clips import clip_captions, repository
from app.store.clips import clip_metadata as metadata_rows
from app.store.clips import versions as library
from app.store.clips.metadata_values import Metadata
from app.store.clips.record import ClipState, folder_of
from app.store.clips.rows import searched_text
from app.store.database import tables as t
from app.store.database.engine import Tx
from app.store.database.text_list import as_list, is_one_of

BATCH = 500
"""Clips in one batch."""


@dataclass(frozen=True, slots=True)
class ClipTexts:
    """The texts of one clip, as in `ClipRecord`; audio_name: the file name of its recording."""

    id: str
    name: str
    file_name: str
    path: str | None
    source: str | None
    audio_name: str | None
    imported: Mapping[str, Any]
    captions: tuple[str, ...]
    words: tuple[str, ...]
    metadata: Metadata


_COLUMNS = tuple(field.name for field in fields(ClipTexts) if field.name in t.clips.c)
_TEXTS = select(*(t.clips.c[name] for name in _COLUMNS)).where(is_one_of(t.clips.c.id, "ids"))
_REMOVE_WORD = delete(t.clip_words).where(
    t.clip_words.c.clip_id == bindparam("the_id"), t.clip_words.c.word == bindparam("the_word")
)
_REMOVE_KEY = delete(t.clip_metadata).where(
    t.clip_metadata.c.clip_id == bindparam("the_id"), t.clip_metadata.c.key == bindparam("the_key")
)


def read(tx: Tx) -> Iterator[ClipTexts]:
    """The texts of all clips."""
    every = tx.execute(select(t.clips.c.id)).scalars().all()
    for ids in repository.in_batches(every, BATCH):
        words, metadata = repository.words_of(tx, ids), metadata_rows.get_many(tx, ids)
        captions = clip_captions.get_many(tx, ids)
        for row in tx.execute(_TEXTS, {"ids": as_list(ids)}).mappings():
            values = dict(row) | {
                "imported": row["imported"] or {},
                "captions": captions.get(row["id"], ()),
            }
            clip_id = row["id"]
            yield ClipTexts(
                **values, words=words.get(clip_id, ()), metadata=metadata.get(clip_id, {})
            )


def write(tx: Tx, changed: Sequence[tuple[ClipTexts, ClipTexts]]) -> None:
    """Store the texts of clips: pairs of the texts before and now. Words and keys only vanish."""
    if not changed:
        return
    is_ready = t.clips.c.state == ClipState.READY.value
    version = case((is_ready, library.bump(tx)), else_=t.clips.c.changed_version)
    change = update(t.clips).where(t.clips.c.id == bindparam("the_id"))
    tx.execute(change.values(changed_version=version), [_row(now) for _, now in changed])
    words = [
        {"the_id": now.id, "the_word": word}
        for before, now in changed
        for word in set(before.words) - set(now.words)
    ]
    keys = [
        {"the_id": now.id, "the_key": key}
        for before, now in changed
        for key in before.metadata.keys() - now.metadata.keys()
    ]
    for before, now in changed:
        if before.captions != now.captions:
            clip_captions.put(tx, now.id, now.captions)
    for statement, rows in ((_REMOVE_WORD, words), (_REMOVE_KEY, keys)):
        if rows:
            tx.execute(statement, rows)


def _row(clip: ClipTexts) -> dict[str, Any]:
    values = {name: getattr(clip, name) for name in _COLUMNS if name != "id"}
    return values | {
        "the_id": clip.id,
        "name_folded": clip.name.casefold(),
        "folder": folder_of(clip.path),
        "searched": searched_text(clip.name, clip.path, clip.metadata, clip.captions),
    }
