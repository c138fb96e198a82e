"""Items for a collection from a filter or a search."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from app.services.collections.collections import MAX_ITEMS
from app.services.find.by_parts import find_by_parts
from app.services.find.queries import ComposedQuery
from app.services.library.filters import resolved_filter
from app.services.library.library import Library
from app.services.views.export_many import ready_ids
from app.store.collections import NewItem


def from_filter(lib: Library, given: Mapping[str, Any]) -> list[NewItem]:
    """The ready clips that pass a filter, at most MAX_ITEMS of them. Raises BadField."""
    found = ready_ids(lib, resolved_filter(lib, given))
    return [NewItem(clip_id) for clip_id in found[:MAX_ITEMS]]


def from_search(lib: Library, query: ComposedQuery) -> list[NewItem]:
    """The first hits of a search, the best first. Raises what `find_by_parts` raises."""
    return [NewItem(hit.clip.id) for hit in find_by_parts(lib, query).items]
