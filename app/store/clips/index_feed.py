"""What an index reads from the library: labels and one array of each clip, in batches.

Rows are streamed and never become `ClipRecord`s, so that a million clips are loaded in
seconds and are never held twice. A ready clip that waits for another analysis comes with the arrays
that it has. An earlier version of the analysis may have made them: an index skips a clip whose
array does not have the shape that it needs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from numpy.typing import NDArray
from sqlalchemy import and_, bindparam, func, select

from app.store.clips.record import ClipState
from app.store.database.blobs import from_blob
from app.store.database.engine import Tx
from app.store.database.tables import clip_arrays, clip_words, clips

BATCH = 5000
"""How many clips are in one batch."""

_WORDS = (
    select(func.aggregate_strings(clip_words.c.word, " "))
    .where(clip_words.c.clip_id == clips.c.id)
    .scalar_subquery()
)
_CLIPS = (
    select(
        clips.c.id,
        clips.c.state,
        clips.c.person,
        clips.c.task,
        clips.c.license,
        clips.c.source,
        clips.c.duration,
        _WORDS,
        clip_arrays.c.dtype,
        clip_arrays.c.shape,
        clip_arrays.c.data,
    )
    .join_from(
        clips,
        clip_arrays,
        and_(clip_arrays.c.clip_id == clips.c.id, clip_arrays.c.name == bindparam("array")),
        isouter=True,
    )
    # Nothing about the state: SQLite would go by its index, through all that are ready.
    .where(clips.c.changed_version > bindparam("since"))
    .order_by(clips.c.changed_version)
)


@dataclass(frozen=True, slots=True)
class IndexedClip:
    """What a search needs to rank and filter a clip.

    duration: seconds; array: the one that was asked for, read-only, None where the clip has
    none (an earlier version of the analysis, which made no such array).
    """

    id: str
    is_ready: bool
    person: str | None
    task: str | None
    license: str | None
    source: str | None
    duration: float
    words: frozenset[str]
    array: NDArray[Any] | None


def changed_since(tx: Tx, since: int, array: str) -> Iterator[list[IndexedClip]]:
    """The clips that changed after library version `since`, oldest change first."""
    asked = {"since": since, "array": array}
    rows = tx.execute(_CLIPS, asked, execution_options={"yield_per": BATCH})
    for batch in rows.partitions(BATCH):
        yield [_indexed(row) for row in batch]


def _indexed(row: Sequence[Any]) -> IndexedClip:
    clip_id, state, person, task, license_, source, duration, words, dtype, shape, data = row
    return IndexedClip(
        clip_id,
        state == ClipState.READY,
        person,
        task,
        license_,
        source,
        duration or 0.0,
        _word_set(words or ""),
        None if data is None else from_blob(dtype, shape, data),
    )


@lru_cache(maxsize=10_000)
def _word_set(text: str) -> frozenset[str]:
    """The words of a text, one object for equal texts: many clips carry the same."""
    return frozenset(text.split(" ")) if text else frozenset()
