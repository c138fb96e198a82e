"""The queries of searches by example, by words, and by several of both."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from app.search.composed.body_parts import BodyPart
from app.search.example.methods import Method
from app.search.pose.pose_matches import MatchesPerClip
from app.services.find.arrangement import PLAIN, Arrangement
from app.services.find.query_source import QuerySource
from app.services.volume_options import STORED_VOLUMES, VolumeOptions
from app.store.clips.filter import ClipFilter

DEFAULT_LIMIT = 10
WORD_MODES = ("default", "cca", "printed")
"""Kernel ridge; Takano's correlated space with a ridge and angles; and as he printed it."""
SCOPES = ("clips", "windows", "segments")
TEMPOS = ("any", "same")
RANKED_BY_IN_SEGMENTS = Method.VECTOR

Filter = ClipFilter | Mapping[str, Any] | None
"""A checked filter, or the conditions as a client sent them, or no filter."""


@dataclass(frozen=True, slots=True)
class MotionQuery:
    """A search by example.

    max_distance: hits are at most this far, in the unit of their `distance` (tau of Sun 2011,
    section 2); None for all. volumes: how the methods msv-dtw and msv-xcorr compare.

    scope: "clips" compares whole clips; "windows" finds parts of clips, at any time in a clip;
    "segments" finds motions from one keypose to the next. segment: only with scope "segments", the
    index of a segment of the queried clip, which is then the query. tempo: for the method fused
    with scope "clips": "any" also finds the motion at another tempo, cut, or repeated; "same"
    compares whole clips at the tempo that they have. limit: 1 to 1,000 hits; include_self: whether
    the query itself may be a hit; cursor: `next` of the page before; clip_fields: fields of each
    hit's clip that are needed, None for all.
    """

    source: QuerySource
    method: Method | str = Method.FUSED
    limit: int = DEFAULT_LIMIT
    filter: Filter = None
    scope: str = "clips"
    segment: int | None = None
    tempo: str = "any"
    max_distance: float | None = None
    volumes: VolumeOptions = STORED_VOLUMES
    include_self: bool = False
    cursor: str | None = None
    clip_fields: frozenset[str] | None = None


@dataclass(frozen=True, slots=True)
class WordQuery:
    """A search by words: its mode is one of WORD_MODES.

    words: words, phrases or sentences; a word with a minus before it (-left) excludes the clips
    that carry it; scope: "clips"; "windows" finds moments, at any time in a clip; "segments" finds
    motions from one keypose to the next; clip_fields: as in `MotionQuery`.
    """

    words: Sequence[str]
    mode: str = "default"
    scope: str = "clips"
    limit: int = DEFAULT_LIMIT
    filter: Filter = None
    cursor: str | None = None
    clip_fields: frozenset[str] | None = None


@dataclass(frozen=True, slots=True)
class PoseQuery:
    """A search by pose: the pose of `source` at `time`, or the pose of 13 `positions`.

    time: seconds from the start of the motion; positions: (13, 3) meters, Y up, in SUN_ROLES
    order; heading and size do not matter; places: whether a clip may be one hit or several;
    include_self: whether the queried clip may be a hit; cursor: `next` of the page before;
    clip_fields: as in `MotionQuery`.
    """

    source: QuerySource | None = None
    time: float | None = None
    positions: Sequence[Sequence[Any]] | None = None
    places: MatchesPerClip | str = MatchesPerClip.BEST
    limit: int = DEFAULT_LIMIT
    filter: Filter = None
    include_self: bool = False
    cursor: str | None = None
    clip_fields: frozenset[str] | None = None


@dataclass(frozen=True, slots=True)
class Example:
    """A motion of a query of several parts.

    part: its place in the query, as in `PartScore`; weight: above 0, relative to the other parts;
    is_against: whether hits must not be like it; body_part: of which alone counts, None for all.
    """

    part: str
    source: QuerySource
    weight: float = 1.0
    is_against: bool = False
    body_part: BodyPart | None = None


@dataclass(frozen=True, slots=True)
class PoseSequence:
    """Poses that a clip takes one after the other. weight, is_against: as in `Example`."""

    poses: Sequence[PoseQuery]
    weight: float = 1.0
    is_against: bool = False


@dataclass(frozen=True, slots=True)
class Rhythm:
    """A rhythm in which a clip moves. rate: cycles per minute; tolerance: a share of it; the others
    are as in `Example`."""

    rate: float
    tolerance: float = 0.1
    weight: float = 1.0
    is_against: bool = False


@dataclass(frozen=True, slots=True)
class ComposedQuery:
    """A search by several parts together; at least one of them must be for something.

    Whole clips are compared. words, mode: as in `WordQuery`; the words together have weight 1; a
    word with a minus leaves out the clips that carry it. include_self: whether clips that are
    examples may be hits. facets: names of `facets.NAMES` to count over all hits. The other fields
    are as in `MotionQuery`.
    """

    examples: Sequence[Example] = ()
    words: Sequence[str] = ()
    poses: PoseSequence | None = None
    rhythm: Rhythm | None = None
    method: Method | str = Method.FUSED
    mode: str = "default"
    limit: int = DEFAULT_LIMIT
    filter: Filter = None
    include_self: bool = False
    arrangement: Arrangement = PLAIN
    facets: Sequence[str] = ()
    cursor: str | None = None
    clip_fields: frozenset[str] | None = None
