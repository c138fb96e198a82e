"""Segments between keyposes, and the cycles that they form."""

from __future__ import annotations

from pydantic import Field

from app.api.schemas.base import Outgoing
from app.services.views import segments


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
    segments: int = Field(ge=1, description="How many it has.")
    start: float = Field(description="Seconds.")
    end: float
    duration: float


class SegmentList(Outgoing):
    """All segments of a clip and their cycles, by time; `next` is always null."""

    items: list[Segment]
    next: str | None = None
    cycles: list[Cycle]

    @classmethod
    def of(cls, found: segments.Segments) -> SegmentList:
        """The segments as the API shows them."""
        return cls(
            items=[
                Segment(
                    index=one.index,
                    start=one.start,
                    end=one.end,
                    duration=round(one.end - one.start, 6),
                    cycle=one.cycle,
                )
                for one in found.segments
            ],
            cycles=[
                Cycle(
                    index=one.index,
                    run=one.run,
                    first=one.first,
                    segments=one.count,
                    start=one.start,
                    end=one.end,
                    duration=round(one.end - one.start, 6),
                )
                for one in found.cycles
            ],
        )
