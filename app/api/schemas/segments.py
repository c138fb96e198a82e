"""Segments between keyposes, and the cycles that they form."""

from __future__ import annotations

from pydantic import Field

from app.api.schemas.base import Outgoing


class Segment(Outgoing):
    """What is danced from one keypose to the next."""

    index: int = Field(ge=0, description="From 0; names it in a search.")
    start: float = Field(description="Seconds.")
    end: float
    duration: float
    cycle: int | None = Field(description="Index of the cycle that it belongs to.")


class Cycle(Outgoing):
    """One time through a sequence of segments that is danced again and again."""

    index: int = Field(ge=0)
    run: int = Field(ge=0, description="Cycles of one run are repetitions of each other.")
    first: int = Field(ge=0, description="Index of its first segment.")
    segments: int = Field(ge=1, validation_alias="count", description="How many it has.")
    start: float = Field(description="Seconds.")
    end: float
    duration: float


class SegmentList(Outgoing):
    """All segments of a clip and their cycles, by time; `next` is always null."""

    items: list[Segment] = Field(validation_alias="segments")
    next: str | None = None
    cycles: list[Cycle]
