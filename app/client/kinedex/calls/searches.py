"""Calls: searches. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from kinedex.call import Call, nothing, path_of, record
from kinedex.sent import UNSET, Unset, corrections, given

if TYPE_CHECKING:
    from kinedex.types.bodies import ComposedSearch
    from kinedex.types.composed_search import ComposedHits
    from kinedex.types.saved_searches import NewHits, SavedSearch, SavedSearchList


def list_searches(*, limit: int | None = None, cursor: str | None = None) -> Call[SavedSearchList]:
    """The saved searches, the newest first.

    limit: Maximum number of items in all; None lists all.
    cursor: Where the list starts: `next` of an earlier page.
    """
    from kinedex.types.saved_searches import SavedSearchList

    return Call(
        "list_searches",
        "GET",
        "/v1/searches",
        record(SavedSearchList),
        query=given(limit=limit, cursor=cursor),
    )


def save_search(name: str, query: ComposedSearch) -> Call[SavedSearch]:
    """Save a search of `POST /v1/search` under a name. Its present hits count as seen.

    query: As in `POST /v1/search`; `limit` is the number of hits that are followed.
    """
    from kinedex.types.saved_searches import SavedSearch

    return Call(
        "save_search",
        "POST",
        "/v1/searches",
        record(SavedSearch),
        json=given(name=name, query=query),
    )


def get_search(search_id: str) -> Call[SavedSearch]:
    """One saved search."""
    from kinedex.types.saved_searches import SavedSearch

    return Call(
        "get_search",
        "GET",
        path_of("/v1/searches/{search_id}", search_id=search_id),
        record(SavedSearch),
    )


def update_search(
    search_id: str,
    *,
    name: str | Unset | None = UNSET,
    query: ComposedSearch | Unset | None = UNSET,
) -> Call[SavedSearch]:
    """Change the name or the query of a saved search.

    query: Its present hits count as seen.
    """
    from kinedex.types.saved_searches import SavedSearch

    return Call(
        "update_search",
        "PATCH",
        path_of("/v1/searches/{search_id}", search_id=search_id),
        record(SavedSearch),
        json=corrections(name=name, query=query),
    )


def delete_search(search_id: str) -> Call[None]:
    """Delete a saved search."""
    return Call(
        "delete_search", "DELETE", path_of("/v1/searches/{search_id}", search_id=search_id), nothing
    )


def run_search(
    search_id: str,
    *,
    limit: int | None = None,
    cursor: str | None = None,
    fields: Sequence[str] | None = None,
) -> Call[ComposedHits]:
    """Run a saved search again. It does not count as looked at: see `POST .../seen`.

    limit: Maximum number of items in all; None lists all.
    cursor: Where the list starts: `next` of an earlier page.
    fields: Members of each item, with commas between them, as in `id,name`; of the clip of a hit
        as in `score,clip.id`. Default: all. Other members are then left out, even if the schema
        of the answer requires them.
    """
    from kinedex.types.composed_search import ComposedHits

    return Call(
        "run_search",
        "GET",
        path_of("/v1/searches/{search_id}/hits", search_id=search_id),
        record(ComposedHits),
        query=given(limit=limit, cursor=cursor, fields=fields),
    )


def get_new_hits(search_id: str) -> Call[NewHits]:
    """The hits that came since a saved search was last looked at.

    A hit is new if it was none then, and its clip came or was changed since. The answer does not
    count as a look: `POST .../seen` does.
    """
    from kinedex.types.saved_searches import NewHits

    return Call(
        "get_new_hits",
        "GET",
        path_of("/v1/searches/{search_id}/new", search_id=search_id),
        record(NewHits),
    )


def mark_search_seen(search_id: str) -> Call[SavedSearch]:
    """Count the present hits of a saved search as seen: they are not new any more."""
    from kinedex.types.saved_searches import SavedSearch

    return Call(
        "mark_search_seen",
        "POST",
        path_of("/v1/searches/{search_id}/seen", search_id=search_id),
        record(SavedSearch),
    )
