"""Exports of several clips: each is a file, and a clip that cannot be exported is left out."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from app.errors import (
    ClipNotFound,
    ClipNotReady,
    LicenseNotAllowed,
    NoGait,
    NotEnoughKeyposes,
)
from app.services.library.filters import resolved_filter
from app.services.library.library import Library
from app.services.views.export import export
from app.services.views.exported import ClipExport, FileNames
from app.store.clips import listing
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipState

LEFT_OUT = (ClipNotFound, ClipNotReady, LicenseNotAllowed, NoGait, NotEnoughKeyposes)
"""Failures that concern one clip, and not the others."""


def ready_ids(lib: Library, filter: ClipFilter) -> tuple[str, ...]:
    """The ids of the ready clips that pass a filter."""
    passing = resolved_filter(lib, filter)
    with lib.store.read() as tx:
        return listing.list_ids(tx, replace(passing, state=(ClipState.READY,)))


def export_each(lib: Library, clip_ids: Sequence[str], **options: Any) -> Iterator[ClipExport]:
    """The clips one after the other; no two files have the same name.

    options: those of `export`. Raises BadField.
    """
    names = FileNames()
    for clip_id in dict.fromkeys(clip_ids):
        try:
            file = export(lib, clip_id, **options)
        except LEFT_OUT as failure:
            yield ClipExport(clip_id, None, failure.detail)
            continue
        yield ClipExport(clip_id, replace(file, file_name=names.free(file.file_name, clip_id)))
