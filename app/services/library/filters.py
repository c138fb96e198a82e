"""Filters of clients, with what only the library knows: the clips of collections."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from app.errors import BadField
from app.kinedex_error import Place
from app.search.index.filters import as_filter
from app.services.library.library import Library
from app.store import collections
from app.store.clips.filter import ClipFilter
from app.store.database.engine import Tx


def resolved_filter(lib: Library, given: ClipFilter | Mapping[str, Any] | None) -> ClipFilter:
    """A filter that searches in memory and lists can use.

    Raises BadField for a filter that cannot be used, and for the id of no collection.
    """
    asked = as_filter(given)
    if not asked.collection:
        return asked
    with lib.store.read() as tx:
        return _with_members(tx, asked)


def _with_members(tx: Tx, asked: ClipFilter) -> ClipFilter:
    unknown = sorted(set(asked.collection) - collections.existing(tx, asked.collection))
    if unknown:
        message = f"is the id of no collection: {', '.join(unknown)}"
        raise BadField("The filter cannot be used.", places=[Place("filter.collection", message)])
    return replace(asked, members=collections.clip_ids(tx, asked.collection))
