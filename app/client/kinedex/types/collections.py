"""Answers: collections. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

from kinedex.records import Page, Record
from kinedex.types.choices import ClipState


@dataclass(frozen=True, slots=True)
class Collection(Record):
    """A named set of clips or parts of clips.

    size: Number of items.
    changed_at: Also of a change of its items.
    """

    id: str
    name: str
    notes: str
    size: int
    created_at: datetime
    changed_at: datetime


@dataclass(frozen=True, slots=True)
class ItemClip(Record):
    """The clip of an item.

    duration: Seconds, of the whole clip.
    """

    id: str
    name: str
    state: ClipState
    duration: float | None
    person: str | None
    task: str | None
    license: str | None


@dataclass(frozen=True, slots=True)
class CollectionItem(Record):
    """An item of a collection.

    start: Start of the part, seconds; null: of the clip.
    end: End of the part, seconds; null: of the clip.
    """

    id: str
    start: float | None
    end: float | None
    notes: str
    clip: ItemClip


@dataclass(frozen=True, slots=True)
class CollectionItemList(Page[CollectionItem]):
    """A page of the items of a collection, in their order.

    next: Cursor of the next page, null on the last page.
    total: Number of items on all pages.
    total_is_exact: False if `total` is an estimate, as in lists of over 100,000 items. Its
    standard deviation is 1 %.
    """

    next: str | None
    total: int
    total_is_exact: bool
    items: list[CollectionItem]


@dataclass(frozen=True, slots=True)
class CollectionList(Page[Collection]):
    """A page of collections, the newest first.

    next: Cursor of the next page, null on the last page.
    total: Number of items on all pages.
    total_is_exact: False if `total` is an estimate, as in lists of over 100,000 items. Its
    standard deviation is 1 %.
    """

    next: str | None
    total: int
    total_is_exact: bool
    items: list[Collection]
