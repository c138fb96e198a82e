"""Answers: saved searches. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Any

from kinedex.records import Page, Record
from kinedex.types.composed_search import ComposedHit


@dataclass(frozen=True, slots=True)
class NewHits(Record):
    """The hits that came since a saved search was last looked at, the best first.

    seen_at: When it was last looked at.
    """

    seen_at: datetime | None
    library_version: int
    items: list[ComposedHit]


@dataclass(frozen=True, slots=True)
class SavedSearch(Record):
    """A saved search.

    query: As it was sent.
    seen_at: When it was last looked at.
    """

    id: str
    name: str
    query: dict[str, Any]
    seen_at: datetime | None
    created_at: datetime


@dataclass(frozen=True, slots=True)
class SavedSearchList(Page[SavedSearch]):
    """A page of saved searches, the newest first.

    next: Cursor of the next page, null on the last page.
    total: Number of items on all pages.
    total_is_exact: False if `total` is an estimate, as in lists of over 100,000 items. Its
    standard deviation is 1 %.
    """

    next: str | None
    total: int
    total_is_exact: bool
    items: list[SavedSearch]
