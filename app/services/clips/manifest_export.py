"""The labels of a library as a table that an import reads again: manifest.csv.

Each row is a clip. The columns are those that a manifest has (`app.services.imports.manifest`),
except `audio`, which names a file that lies beside the motion. No cell is a formula (`formulas`).
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence

from app.formats.csv.formulas import guarded
from app.services import clip_fields
from app.services.library.filters import resolved_filter
from app.services.library.library import Library
from app.store.clips import keypose_annotations
from app.store.clips import listing as clip_listing
from app.store.clips import repository as clips
from app.store.clips.filter import ClipFilter
from app.store.clips.metadata_values import as_cell
from app.store.clips.record import META, ClipRecord
from app.store.database.engine import Tx

BATCH = 500
"""Clips that are read at a time."""
LABELS = ("name", "person", "task", "words", "license", "source", "captions")
HINTS = ("frame_rate", "unit", "audio_offset", "tempo", "beats")
KEYPOSES = "keyposes"


def manifest(lib: Library, filter: ClipFilter | None = None) -> Iterator[bytes]:
    """A manifest of the clips that pass a filter, sorted by path, as blocks of UTF-8.

    A clip that came without a path has the name of its file as its path. The columns of metadata
    are called `meta.KEY`, which is metadata whatever the key is. Raises BadField, before the first
    block.
    """
    return _blocks(lib, resolved_filter(lib, filter))


def _blocks(lib: Library, passing: ClipFilter) -> Iterator[bytes]:
    with lib.store.read() as tx:
        ids, keys = clip_listing.ids_by_path(tx, passing)
    yield _lines([["path", *LABELS, *HINTS, KEYPOSES, *(META + key for key in keys)]])
    for batch in clips.in_batches(ids, BATCH):
        with lib.store.read() as tx:
            rows = list(_rows(tx, batch, keys))
        yield _lines(rows)


def _rows(tx: Tx, ids: Sequence[str], keys: Sequence[str]) -> Iterator[list[str]]:
    keyposes = keypose_annotations.get_many(tx, ids)
    for clip in clips.get_many(tx, ids).values():
        yield [
            guarded(clip.path or clip.file_name),
            *(guarded(_cell(getattr(clip, name))) for name in LABELS[:-1]),
            guarded(" | ".join(clip.captions)),
            *(_cell(_hint(clip, name)) for name in HINTS),
            _cell(keyposes.get(clip.id)),
            *(_metadata_cell(clip, key) for key in keys),
        ]


def _metadata_cell(clip: ClipRecord, key: str) -> str:
    value = clip.metadata.get(key, "")
    return guarded(as_cell(value)) if isinstance(value, str) else as_cell(value)


def _hint(clip: ClipRecord, name: str) -> object:
    return getattr(clip.hints, clip_fields.stored_name(name))


def _cell(value: object) -> str:
    if value is None:
        return ""
    return " ".join(map(str, value)) if isinstance(value, tuple) else str(value)


def _lines(rows: Sequence[Sequence[str]]) -> bytes:
    text = io.StringIO(newline="")
    csv.writer(text).writerows(rows)
    return text.getvalue().encode()
