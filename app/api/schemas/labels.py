"""Persons, tasks and words with their counts."""

from __future__ import annotations

from pydantic import Field

from app.api.schemas.base import Outgoing


class NamedCount(Outgoing):
    """A label and how many clips carry it."""

    name: str
    count: int = Field(ge=0)


class NamedCounts(Outgoing):
    """All labels of a kind, by name; `next` is always null."""

    items: list[NamedCount]
    next: str | None = None

    @classmethod
    def of(cls, counts: list[tuple[str, int]]) -> NamedCounts:
        """Labels as they go over the wire."""
        return cls(items=[NamedCount(name=name, count=count) for name, count in counts])
