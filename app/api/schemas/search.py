"""Searches by example and by words."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field, Json

from app.api.schemas.base import (
    PRINTABLE,
    ROUNDED,
    Cursor,
    Incoming,
    Limit,
    Outgoing,
    Probability,
    Seconds,
)
from app.api.schemas.clips import Clip
from app.api.schemas.filters import Filter
from app.api.schemas.query_source import ClipId, QueryFields, QueryForm
from app.search.example.methods import Method
from app.services.find.queries import MotionQuery, WordQuery
from app.services.find.query_source import QuerySource
from app.services.volume_options import MAX_CLIPS, MAX_ETA, VolumeOptions


class _MotionOptions(QueryFields):
    start: Seconds | None = Field(None, description="Start of the queried part, seconds.")
    end: Seconds | None = Field(None, description="End of the queried part, seconds.")
    method: Method = Method.FUSED
    limit: Limit = 10
    scope: Literal["clips", "windows", "segments"] = Field(
        "clips",
        description="clips: whole clips are compared. windows: parts of clips are found, at any "
        "time in a clip, by the methods fused, vector and dtw; the query is up to 120 s long. "
        "segments: motions from one keypose to the next are compared by their vectors; the query "
        "is taken as one segment.",
    )
    tempo: Literal["any", "same"] = Field(
        "any",
        description="For method fused with scope clips. any: the motion is also found played "
        "faster or slower, cut, or repeated; of two equal hits, the one at the tempo of the query "
        "comes first. same: tempo is a part of the motion, and whole clips are compared as they "
        "are.",
    )
    max_distance: float | None = Field(
        None,
        ge=0,
        allow_inf_nan=False,
        description="Only hits whose `distance` is at most this; `limit` and `next` still make "
        "pages. Units of distances: vector: of motion vectors, Euclidean. dtw: body lengths, the "
        "mean over aligned frames. fused: of both and of the graph of neighbors; behind the 300 "
        "nearest it goes on from the last of them. msv-dtw: D_dtw (Sun 2011, equation 7). "
        "msv-xcorr: 3 - D_xcorr (equation 6). metric-*: Euclidean, in learned coordinates.",
    )
    q: int = Field(
        2,
        ge=1,
        le=2,
        description="For methods msv-dtw and msv-xcorr with scope clips: the norm of the distances "
        "between joints, 1 or 2 (Sun 2011, equation 2). With 1, the volumes of all clips that pass "
        f"the filter are computed for the search, 20 ms each; at most {MAX_CLIPS} clips.",
    )
    eta: float = Field(
        0.0,
        ge=0,
        le=MAX_ETA,
        allow_inf_nan=False,
        description="For the same methods: above 0, a cell of a self-similarity matrix is 1 where "
        "two joints are at most this many body lengths apart, else 0. 0, the paper's choice, keeps "
        "the distances. It costs as much as q = 1.",
    )
    normalized: bool = Field(
        False,
        description="For method msv-xcorr. As printed, D_xcorr of two motions falls with the ratio "
        "of their lengths: of T and U > T frames, the correlation in time is about sqrt(T / U) at "
        "most. true: the shorter motion is compared with parts of the longer one as long as it, so "
        "that a long motion can be like a short one.",
    )
    include_self: bool = Field(
        False,
        description="Whether the query clip may be a hit. A file that is stored already counts as "
        "its clip. With scope windows and segments: whether parts that overlap the query may be "
        "hits.",
    )
    filter: Filter | None = None
    cursor: Cursor | None = None

    def query(self, source: QuerySource, segment: int | None = None) -> MotionQuery:
        """The search for a motion. segment: as in `MotionSearch`."""
        return MotionQuery(
            source=source,
            method=self.method,
            limit=self.limit,
            filter=None if self.filter is None else self.filter.given(),
            scope=self.scope,
            segment=segment,
            tempo=self.tempo,
            max_distance=self.max_distance,
            volumes=VolumeOptions(self.q, self.eta, self.normalized),
            include_self=self.include_self,
            cursor=self.cursor,
        )


class MotionSearch(_MotionOptions):
    """Find motions like a stored clip or a part of it."""

    clip_id: ClipId
    segment: int | None = Field(
        None,
        ge=0,
        le=10**6,
        description="With scope segments: the clip's segment of that index is the query.",
    )

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {"clip_id": "CLIP_ID", "limit": 5},
                {"clip_id": "CLIP_ID", "start": 0.5, "end": 1.5, "filter": {"task": "walk"}},
                {"clip_id": "CLIP_ID", "start": 0.5, "end": 2.5, "scope": "windows"},
                {"clip_id": "CLIP_ID", "segment": 0, "scope": "segments"},
            ]
        }
    )


class MotionSearchForm(_MotionOptions, QueryForm):
    """Find motions like an uploaded one (never stored), or like a stored clip."""

    filter: Json[Filter] | None = Field(None, description='JSON, as {"task": ["walk", "run"]}.')


_Word = Annotated[str, Field(min_length=1, max_length=300, json_schema_extra=PRINTABLE)]


class WordSearch(Incoming):
    """Find motions for words."""

    words: list[_Word] = Field(
        min_length=1,
        max_length=100,
        description=(
            "Words, phrases or sentences. Inflected forms and words of the same meaning are "
            "understood. A word with a minus before it (-left) leaves out the clips that carry it."
        ),
    )
    mode: Literal["default", "cca", "printed"] = Field(
        "default",
        description=(
            "How clips are ranked. default: by a kernel regression from motion features to words. "
            "cca: by the angle in Takano's correlated space of motion symbols and words, with a "
            "ridge and with as many dimensions as predict held-out words best. printed: by the "
            "distance in that space as Takano printed it, with the pseudo-inverse and 10 "
            "dimensions."
        ),
    )
    scope: Literal["clips", "windows", "segments"] = Field(
        "clips",
        description="clips: whole clips are ranked. windows: moments are found, at any time in a "
        "clip, with their start and end. segments: motions from one keypose to the next are "
        "ranked. With windows and segments, `mode` is default, and a word with a minus leaves out "
        "the times at which it is likelier than not.",
    )
    limit: Limit = 10
    filter: Filter | None = None
    cursor: Cursor | None = None

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {"words": ["an old man waves with his left hand", "-tired"]},
                {"words": ["kick"], "mode": "cca"},
                {"words": ["kick", "-left"], "scope": "windows"},
            ]
        }
    )

    def query(self) -> WordQuery:
        """The search for words."""
        return WordQuery(
            words=self.words,
            mode=self.mode,
            scope=self.scope,
            limit=self.limit,
            filter=None if self.filter is None else self.filter.given(),
            cursor=self.cursor,
        )


def _rounded(seconds: float) -> float:
    return round(seconds, 6)


HitSeconds = Annotated[float, AfterValidator(_rounded)]


class Hit(Outgoing):
    """One hit of a search."""

    rank: int = Field(ge=1)
    score: float = Field(ge=0, le=1, description="Higher is closer.")
    distance: float = Field(
        description="Its unit depends on the search; `max_distance` of a search by example names "
        "those of the methods."
    )
    start: HitSeconds = Field(
        description="Start of the found part, seconds from the start of the clip. 0 with scope "
        "clips."
    )
    end: HitSeconds = Field(description="End of the found part, seconds.")
    clip: Clip


class MotionHits(Outgoing):
    """A page of a ranking, the nearest first."""

    method: str
    took_ms: float
    library_version: int
    items: list[Hit]
    next: str | None


class WordHit(Hit):
    """One hit of a search by words."""

    score: Probability = Field(
        description=(
            "Probability that the clip carries all requested words. It is calibrated on "
            "held-out clips, so that scores of different queries can be compared. If a word is "
            "replaced by others because no clip carries it, the most probable of them counts, "
            f"reduced by the distance between the two meanings. {ROUNDED}"
        ),
    )
    distance: float = Field(
        description="-ln(score) in mode default; 1 - cosine, 0 to 2, in mode cca; Euclidean in "
        "mode printed."
    )


def _none_as_empty(value: Any) -> Any:
    return {} if value is None else value


UnknownWords = Annotated[list[str], Field(description="Words that no clip carries.")]
Expanded = Annotated[
    dict[str, list[str]],
    BeforeValidator(_none_as_empty),
    Field(
        description="For each word that no clip carries, the words that were used instead: words "
        "of the library, or a detector of what the word names (`left foot moves`)."
    ),
]
Confidence = Annotated[
    dict[str, Probability],
    BeforeValidator(_none_as_empty),
    Field(
        description="For each word of `expanded`, how sure it is that the replacement means the "
        "same: 1 for another form of the word. Scores are multiplied by it."
    ),
]


class WordHits(Outgoing):
    """A page of a ranking by words, the most probable first."""

    method: str
    took_ms: float
    library_version: int
    items: list[WordHit]
    next: str | None
    unknown_words: UnknownWords
    expanded: Expanded
    confidence: Confidence
