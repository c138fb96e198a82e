"""Saved searches: save a query, run it again, and be told of hits that came since.

The hits of a saved search are the first ones of its query, as many as its `limit`. A hit is new if
it was none when the search was last looked at, and its clip has changed since: it came, or has
other labels. So a hit that only moved up, since another clip was deleted, is not new.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from app.services import fields
from app.services.fields import bad_field
from app.services.find.by_parts import find_by_parts
from app.services.find.hits import Hits
from app.services.find.queries import ComposedQuery
from app.services.library.library import Library
from app.store import audit
from app.store import saved_searches as stored
from app.store.clips.record import ClipRecord
from app.store.database.paging import Page
from app.store.saved_searches import SearchRecord


def save(lib: Library, name: str, query: ComposedQuery, as_sent: Mapping[str, Any]) -> SearchRecord:
    """Save a search; its present hits count as seen. as_sent: the query as the client sent it.

    Raises BadField, Conflict if another one has the name, and what `find_by_parts` raises.
    """
    tidy = _name(name)
    found = find_by_parts(lib, query)
    with lib.store.write() as tx:
        made = stored.add(tx, tidy, as_sent)
        audit.note(search_id=made.id)
        return stored.mark_seen(tx, made.id, _ids(found), found.library_version)


def get(lib: Library, search_id: str) -> SearchRecord:
    """A saved search by id. Raises SearchNotFound."""
    with lib.store.read() as tx:
        return stored.get(tx, search_id)


def list_page(lib: Library, limit: int, cursor: str | None = None) -> Page[SearchRecord]:
    """One page of saved searches, newest first. Raises PageNotFound for a bad cursor."""
    with lib.store.read() as tx:
        return stored.list_page(tx, limit=limit, cursor=cursor).counted(stored.total(tx))


def change(
    lib: Library,
    search_id: str,
    *,
    name: str | None = None,
    query: ComposedQuery | None = None,
    as_sent: Mapping[str, Any] | None = None,
) -> SearchRecord:
    """Change name or query; the present hits of a new query count as seen.

    Raises SearchNotFound, BadField, Conflict, and what `find_by_parts` raises.
    """
    tidy = None if name is None else _name(name)
    found = None if query is None else find_by_parts(lib, query)
    with lib.store.write() as tx:
        changed = stored.change(tx, search_id, name=tidy, query=as_sent)
        if found is None:
            return changed
        return stored.mark_seen(tx, search_id, _ids(found), found.library_version)


def remove(lib: Library, search_id: str) -> None:
    """Remove a saved search. Raises SearchNotFound."""
    lib.store.write_even_when_full(lambda tx: stored.remove(tx, search_id))


def new_hits(lib: Library, search: SearchRecord, query: ComposedQuery) -> Hits:
    """The hits that came since the search was last looked at. query: that of the search."""
    found = find_by_parts(lib, query)
    seen = frozenset(search.seen)
    items = tuple(
        hit
        for hit in found.items
        if hit.clip.id not in seen
        and isinstance(hit.clip, ClipRecord)
        and hit.clip.changed_version > search.seen_version
    )
    return replace(found, items=items, next=None)


def look_at(lib: Library, search_id: str, query: ComposedQuery) -> SearchRecord:
    """Count the present hits as seen. query: that of the search. Raises SearchNotFound."""
    found = find_by_parts(lib, query)
    with lib.store.write() as tx:
        return stored.mark_seen(tx, search_id, _ids(found), found.library_version)


def _ids(found: Hits) -> list[str]:
    return [hit.clip.id for hit in found.items]


def _name(value: str) -> str:
    name = fields.text("name", value)
    if name is None:
        raise bad_field("name", "must not be empty")
    return name
