"""The results of searches: pages of hits."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass

from app.search.index.facets import Facet
from app.store.clips.partial import PartialClip
from app.store.clips.record import ClipRecord


@dataclass(frozen=True, slots=True)
class PartScore:
    """How likely one part of a query is true of a hit.

    part: the part's place in the query (examples.0, file, words.1); is_against: whether the query
    is against it; score: 0..1, the probability that the hit is like the example, or carries the
    words; cost: at least 0, what the part adds to the distance of the hit.
    """

    part: str
    is_against: bool
    score: float
    cost: float


@dataclass(frozen=True, slots=True)
class HitGroup:
    """The group of a hit. by: what it is a group by; value: its name, "" for clips without a label,
    None for a clip that has no near-duplicates; count: its hits."""

    by: str
    value: str | None
    count: int


@dataclass(frozen=True, slots=True)
class Hit:
    """One clip, or one part of a clip, that was found.

    rank: from 1; score: 0..1, higher is closer, and lower for each larger distance; distance: its
    unit depends on the method; start, end: seconds, the part of the clip that was found (the whole
    clip with scope "clips"); time: seconds, of the nearest pose in a search by pose;
    clip: with the requested fields; parts: of a query of several parts; group: of hits in
    groups.
    """

    rank: int
    score: float
    distance: float
    start: float
    end: float
    clip: ClipRecord | PartialClip
    time: float | None = None
    parts: tuple[PartScore, ...] = ()
    group: HitGroup | None = None


@dataclass(frozen=True, slots=True)
class Hits:
    """One page of a ranking.

    method: the method of the ranking; took_ms: milliseconds; library_version: of the library that
    was searched; next: cursor of the following page, None after the last one; unknown_words: words
    of a search by words that the model does not know; expanded: words or detectors that replaced
    an unknown word, by unknown word; confidence: how sure that is, 0..1, by unknown word; facets:
    of all hits on all pages, by name.
    """

    method: str
    took_ms: float
    library_version: int
    items: tuple[Hit, ...]
    next: str | None = None
    unknown_words: tuple[str, ...] = ()
    expanded: dict[str, tuple[str, ...]] | None = None
    confidence: dict[str, float] | None = None
    facets: Mapping[str, Facet] | None = None


@dataclass(frozen=True, slots=True)
class HitPage:
    """The hits of one page, and the cursor of the next one (None after the last page)."""

    items: tuple[Hit, ...]
    next: str | None


def milliseconds_since(began: float) -> float:
    """Milliseconds since `began`, an earlier value of `time.perf_counter`, to a microsecond."""
    return round((time.perf_counter() - began) * 1000.0, 3)
