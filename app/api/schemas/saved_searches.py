"""Saved searches."""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime
from typing import Annotated, Any

from pydantic import ConfigDict, Field

from app.api.schemas.base import (
    NAMED,
    Cursor,
    Fields,
    Incoming,
    Label,
    Limit,
    Outgoing,
    Paged,
    not_null,
)
from app.api.schemas.composed_search import ComposedHit, ComposedSearch
from app.services.find.queries import ComposedQuery
from app.store.saved_searches import SearchRecord

_Name = Annotated[Label, Field(json_schema_extra=NAMED)]


def as_stored(query: ComposedSearch) -> dict[str, Any]:
    """The query as it is saved: what was sent, without a cursor."""
    sent = query.model_dump(mode="json", exclude_unset=True, exclude={"cursor", "filter"})
    return sent if query.filter is None else {**sent, "filter": query.filter.given()}


def as_query(search: SearchRecord, **changes: Any) -> ComposedSearch:
    """The saved query. changes: other values of its fields. Raises ValidationError."""
    return ComposedSearch.model_validate({**search.query, **changes})


def first_page(query: ComposedSearch) -> ComposedQuery:
    """The query of the service, from the first hit."""
    return replace(query.query(), cursor=None)


class NewSearch(Incoming):
    """A search to save."""

    name: _Name
    query: ComposedSearch = Field(
        description="As in `POST /v1/search`; `limit` is the number of hits that are followed."
    )

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {"name": "like this", "query": {"examples": [{"clip_id": "CLIP_ID"}], "limit": 20}}
            ]
        }
    )


class SearchPatch(Incoming):
    """Changes of a saved search. Only the sent fields change."""

    name: _Name | None = Field(None, json_schema_extra=not_null)
    query: ComposedSearch | None = Field(
        None, json_schema_extra=not_null, description="Its present hits count as seen."
    )

    model_config = ConfigDict(json_schema_extra={"examples": [{"name": "like that"}]})


class SearchPage(Incoming):
    """A page of hits of a saved search."""

    limit: Limit | None = Field(None, description="Default: that of the query.")
    cursor: Cursor | None = None
    fields: Fields | None = None


class SavedSearch(Outgoing):
    """A saved search."""

    id: str
    name: str
    query: dict[str, Any] = Field(description="As it was sent.")
    seen_at: datetime | None = Field(description="When it was last looked at.")
    created_at: datetime


class SavedSearchList(Paged):
    """A page of saved searches, the newest first."""

    items: list[SavedSearch]


class NewHits(Outgoing):
    """The hits that came since a saved search was last looked at, the best first."""

    seen_at: datetime | None = Field(description="When it was last looked at.")
    library_version: int
    items: list[ComposedHit]
