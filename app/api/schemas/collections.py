"""Collections of clips and parts of clips."""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime
from typing import Annotated, Any

from pydantic import ConfigDict, Field

from app.api.schemas.base import (
    NAMED,
    Cursor,
    Fps,
    Incoming,
    Label,
    Limit,
    Outgoing,
    Paged,
    Seconds,
    not_null,
)
from app.api.schemas.composed_search import ComposedSearch
from app.api.schemas.filters import Filter
from app.api.schemas.query_source import ClipId
from app.services.collections.collections import MAX_ITEMS, MAX_NOTES
from app.services.collections.filling import from_filter, from_search
from app.services.library.library import Library
from app.services.views.export_format import (
    ExportFormat,
    ExportJoints,
    ExportSkeleton,
    ExportUnit,
)
from app.store.clips.record import ClipState
from app.store.collections import NewItem

MAX_ADDED = 1000
"""Items that one call lists; a filter or a search may add more."""
_LINES = {"pattern": r"^[^\u0000-\u0008\u000b\u000c\u000e-\u001f\u007f-\u009f]*$"}
Notes = Annotated[str, Field(max_length=MAX_NOTES, json_schema_extra=_LINES)]
"""Text of several lines."""


class CollectionItemForm(Incoming):
    """A clip, or a part of it, to add to a collection."""

    clip_id: ClipId
    start: Seconds | None = Field(None, description="Start of the part, seconds.")
    end: Seconds | None = Field(None, description="End of the part, seconds.")
    notes: Notes = ""

    def item(self) -> NewItem:
        """The item of the store."""
        return NewItem(self.clip_id, self.start, self.end, self.notes)


class CollectionItems(Incoming):
    """Items to add: those that are listed, then the clips of a filter, then the hits of a search.

    They come behind the items that the collection has.
    """

    items: list[CollectionItemForm] = Field(default_factory=list, max_length=MAX_ADDED)
    filter: Filter | None = Field(None, description="All ready clips that pass it.")
    search: ComposedSearch | None = Field(
        None, description="The first hits of this search, the best first: its `limit` of them."
    )

    model_config = ConfigDict(
        json_schema_extra={"examples": [{"items": [{"clip_id": "CLIP_ID", "start": 0, "end": 1}]}]}
    )

    def found(self, lib: Library) -> list[NewItem]:
        """All items to add. Raises what a filter and a search raise."""
        added = [one.item() for one in self.items]
        if self.filter is not None:
            added += from_filter(lib, self.filter.given())
        if self.search is not None:
            added += from_search(lib, replace(self.search.query(), cursor=None))
        return added


class NewCollection(CollectionItems):
    """A collection to make, with its first items."""

    name: Annotated[Label, Field(json_schema_extra=NAMED)]
    notes: Notes = ""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {"name": "walks for motion matching", "filter": {"task": ["walk"]}},
            ]
        }
    )


class CollectionPatch(Incoming):
    """Changes of a collection. Only the sent fields change."""

    name: Annotated[Label, Field(json_schema_extra=NAMED)] | None = Field(
        None, json_schema_extra=not_null
    )
    notes: Notes | None = Field(None, description="null removes them.")

    model_config = ConfigDict(json_schema_extra={"examples": [{"notes": "without turns"}]})


class ItemPatch(Incoming):
    """Changes of an item. Only the sent fields change."""

    start: Seconds | None = Field(None, description="null: the start of the clip.")
    end: Seconds | None = Field(None, description="null: the end of the clip.")
    notes: Notes | None = Field(None, description="null removes them.")

    model_config = ConfigDict(json_schema_extra={"examples": [{"start": 0.5, "notes": "the best"}]})


class ItemOrder(Incoming):
    """The order of items: these come first, the others follow in theirs."""

    item_ids: list[Annotated[str, Field(max_length=100)]] = Field(
        min_length=1, max_length=MAX_ITEMS
    )


class Collection(Outgoing):
    """A named set of clips or parts of clips."""

    id: str
    name: str
    notes: str
    size: int = Field(description="Number of items.")
    created_at: datetime
    changed_at: datetime = Field(description="Also of a change of its items.")


class CollectionList(Paged):
    """A page of collections, the newest first."""

    items: list[Collection]


class ItemClip(Outgoing):
    """The clip of an item."""

    id: str
    name: str
    state: ClipState
    duration: float | None = Field(description="Seconds, of the whole clip.")
    person: str | None
    task: str | None
    license: str | None


class CollectionItem(Outgoing):
    """An item of a collection."""

    id: str
    start: float | None = Field(description="Start of the part, seconds; null: of the clip.")
    end: float | None = Field(description="End of the part, seconds; null: of the clip.")
    notes: str
    clip: ItemClip

    @classmethod
    def of(cls, item: Any) -> CollectionItem:
        """The item of the service."""
        record = item.record
        return cls(
            id=record.id,
            start=record.start,
            end=record.end,
            notes=record.notes,
            clip=ItemClip.model_validate(item.clip),
        )


class CollectionItemList(Paged):
    """A page of the items of a collection, in their order."""

    items: list[CollectionItem]


class ListPage(Incoming):
    """A page of a list."""

    limit: Limit = 50
    cursor: Cursor | None = None


class CollectionExport(Incoming):
    """How a collection is exported."""

    format: ExportFormat
    skeleton: ExportSkeleton = Field(
        ExportSkeleton.OWN, description="own: each clip's joints; canonical: one body for all."
    )
    joints: ExportJoints = ExportJoints.ALL
    unit: ExportUnit | None = None
    fps: Fps | None = Field(None, description="Default: each clip's own rate.")
