"""Answers: pose. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass

from kinedex.records import Page, Record
from kinedex.types.clips import Clip


@dataclass(frozen=True, slots=True)
class PoseHit(Record):
    """A time at which a clip takes a pose; it stays near the pose from start to end.

    score: Higher is closer.
    distance: Its unit depends on the search; `max_distance` of a search by example names those
    of the methods.
    start: Start of the found part, seconds from the start of the clip. 0 with scope clips.
    end: End of the found part, seconds.
    time: Seconds: when the clip is nearest to the pose.
    """

    rank: int
    score: float
    distance: float
    start: float
    end: float
    clip: Clip
    time: float


@dataclass(frozen=True, slots=True)
class PoseHits(Page[PoseHit]):
    """A page of a ranking by pose, the nearest first."""

    method: str
    took_ms: float
    library_version: int
    items: list[PoseHit]
    next: str | None
