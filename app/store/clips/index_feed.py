"""Reads the data of a search index: the labels and one array of each clip, in batches.

Rows are streamed and never become `ClipRecord`s, so that a million clips are loaded in seconds
and are never in memory twice. A ready clip that waits for another analysis comes with its current
arrays. An earlier version of the analysis may have computed them: an index skips a clip whose
array does not have the shape that the index needs.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from numpy.typing import NDArray
from sqlalchemy import and_, bindparam, func, select

from app.store.clips.measures import FOUND, QUALITY
from app.store.clips.metadata_values import MetadataValue, from_text
from app.store.clips.record import ClipState
from app.store.database.blobs import from_blob_if_whole
from app.store.database.engine import Tx
from app.store.database.tables import clip_arrays, clip_measures, clip_metadata, clip_words, clips

BATCH = 5000
"""Clips in one batch."""

_WORDS = (
    select(func.aggregate_strings(clip_words.c.word, " "))
    .where(clip_words.c.clip_id == clips.c.id)
    .scalar_subquery()
)
# Control characters, because no key and no value holds any.
_BETWEEN_PARTS, _BETWEEN_VALUES = "\x1f", "\x1e"
_METADATA = (
    select(
        func.aggregate_strings(
            clip_metadata.c.key
            + _BETWEEN_PARTS
            + clip_metadata.c.kind
            + _BETWEEN_PARTS
            + clip_metadata.c.text,
            _BETWEEN_VALUES,
        )
    )
    .where(clip_metadata.c.clip_id == clips.c.id)
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
        *(clips.c[name] for name in FOUND),
        *(clip_measures.c[name] for name in QUALITY),
        clips.c.folder,
        clips.c.created_at,
        _METADATA,
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
    .join(clip_measures, clip_measures.c.clip_id == clips.c.id, isouter=True)
    # No condition on the state: SQLite would use the index of the state and read all ready clips.
    .where(clips.c.changed_version > bindparam("since"))
    .order_by(clips.c.changed_version)
)


IndexedMeasures = tuple[float, ...]
"""The measures FOUND of a clip; NaN for one that it lacks."""

IndexedMetadata = tuple[tuple[str, MetadataValue], ...]
"""The keys of a clip's metadata, each with its value."""


UNKNOWN: IndexedMeasures = (math.nan,) * len(FOUND)
"""The measures of a clip that lacks them all."""

UNKNOWN_QUALITY: IndexedMeasures = (math.nan,) * len(QUALITY)


@dataclass(frozen=True, slots=True)
class IndexedClip:
    """The data of a clip that a search needs to rank and filter it.

    duration: seconds; array: the requested array, read-only, None if the clip does not have it
    (an earlier version of the analysis did not compute it) or if it is damaged; folder: None if the
    clip came without a path; quality: the measures QUALITY, NaN for those that it lacks;
    created: when the clip came, seconds since 1970.
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
    folder: str | None = None
    metadata: IndexedMetadata = ()
    measures: IndexedMeasures = UNKNOWN
    quality: IndexedMeasures = UNKNOWN_QUALITY
    created: float = 0.0


def changed_since(tx: Tx, since: int, array: str) -> Iterator[list[IndexedClip]]:
    """Batches of the clips that changed after library version `since`, oldest change first.

    array: name of the array to load with each clip.
    """
    parameters = {"since": since, "array": array}
    rows = tx.execute(_CLIPS, parameters, execution_options={"yield_per": BATCH})
    for batch in rows.partitions(BATCH):
        yield [_indexed(row) for row in batch]


def _indexed(row: Sequence[Any]) -> IndexedClip:
    clip_id, state, *rest, folder, created, metadata, dtype, shape, data = row
    person, task, license_, source, duration, words, *measures = rest
    return IndexedClip(
        clip_id,
        state == ClipState.READY,
        person,
        task,
        license_,
        source,
        duration or 0.0,
        _word_set(words or ""),
        None if data is None else from_blob_if_whole(dtype, shape, data),
        folder,
        _metadata_of(metadata or ""),
        _with_nan(measures[: len(FOUND)]),
        _with_nan(measures[len(FOUND) :]),
        created.timestamp(),
    )


def _with_nan(values: Sequence[float | None]) -> IndexedMeasures:
    return tuple(math.nan if value is None else value for value in values)


@lru_cache(maxsize=10_000)
def _word_set(text: str) -> frozenset[str]:
    # Cached: many clips have the same words, and equal texts then share one object.
    return frozenset(text.split(" ")) if text else frozenset()


@lru_cache(maxsize=10_000)
def _metadata_of(text: str) -> IndexedMetadata:
    return tuple(map(_key_and_value, text.split(_BETWEEN_VALUES))) if text else ()


def _key_and_value(text: str) -> tuple[str, MetadataValue]:
    key, kind, value = text.split(_BETWEEN_PARTS)
    return key, from_text(kind, value)
