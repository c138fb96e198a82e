"""The queries of searches by example and by words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from app.search.example.methods import Method
from app.services.find.query_source import QuerySource
from app.store.clips.filter import ClipFilter

DEFAULT_LIMIT = 10
SCOPES = ("clips", "windows", "segments")
RANKED_BY_IN_SEGMENTS = Method.VECTOR

Filter = ClipFilter | Mapping[str, Any] | None
"""A checked filter, or the conditions as a client sent them, or no filter."""


@dataclass(frozen=True, slots=True)
class MotionQuery:
    """A search by example.

    scope: "clips" compares whole clips; "windows" finds parts of clips, at any time in a clip;
    "segments" finds motions from one keypose to the next. segment: only with scope "segments", the
    index of a segment of the queried clip, which is then the query. limit: 1 to 1,000 hits;
    include_self: whether the query itself may be a hit; cursor: `next` of the page before;
    clip_fields: fields of each hit's clip that are needed, None for all.
    """

    source: QuerySource
    method: Method | str = Method.FUSED
    limit: int = DEFAULT_LIMIT
    filter: Filter = None
    scope: str = "clips"
    segment: int | None = None
    include_self: bool = False
    cursor: str | None = None
    clip_fields: frozenset[str] | None = None


@dataclass(frozen=True, slots=True)
class WordQuery:
    """A search by words: mode "default" (kernel ridge) or "cca" (Takano's correlated space).

    words: words, phrases or sentences; a word with a minus before it (-left) excludes the clips
    that carry it; clip_fields: as in `MotionQuery`.
    """

    words: Sequence[str]
    mode: str = "default"
    limit: int = DEFAULT_LIMIT
    filter: Filter = None
    cursor: str | None = None
    clip_fields: frozenset[str] | None = None
