"""Segments between keyposes, and cycles of segments."""

from __future__ import annotations

from pydantic import Field

from app.api.schemas.base import Outgoing


class Segment(Outgoing):
    """The motion from one keypose to the next."""

    index: int = Field(ge=0, description="From 0. A search names the segment by it.")
    start: float = Field(description="Seconds.")
    end: float
    duration: float
    cycle: int | None = Field(description="Index of the cycle of this segment.")


class Cycle(Outgoing):
    """One repetition of a repeated sequence of segments."""

    index: int = Field(ge=0)
    run: int = Field(ge=0, description="Cycles with the same run repeat the same sequence.")
    first: int = Field(ge=0, description="Index of the first segment.")
    segments: int = Field(ge=1, validation_alias="count", description="Number of segments.")
    start: float = Field(description="Seconds.")
    end: float
    duration: float


class SegmentList(Outgoing):
    """All segments of a clip and their cycles, by time; `next` is always null."""

    items: list[Segment] = Field(validation_alias="segments")
    next: str | None = None
    cycles: list[Cycle]
