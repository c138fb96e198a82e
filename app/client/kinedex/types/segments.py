"""Answers: segments. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass

from kinedex.records import Page, Record


@dataclass(frozen=True, slots=True)
class Cycle(Record):
    """One repetition of a repeated sequence of segments.

    run: Cycles with the same run repeat the same sequence.
    first: Index of the first segment.
    segments: Number of segments.
    start: Seconds.
    """

    index: int
    run: int
    first: int
    segments: int
    start: float
    end: float
    duration: float


@dataclass(frozen=True, slots=True)
class Segment(Record):
    """The motion from one keypose to the next.

    index: From 0. A search names the segment by it.
    start: Seconds.
    cycle: Index of the cycle of this segment.
    """

    index: int
    start: float
    end: float
    duration: float
    cycle: int | None


@dataclass(frozen=True, slots=True)
class SegmentList(Page[Segment]):
    """All segments of a clip and their cycles, by time; `next` is always null."""

    items: list[Segment]
    next: str | None
    cycles: list[Cycle]
