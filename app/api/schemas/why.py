"""Why a clip is a hit of a search by several parts."""

from __future__ import annotations

from pydantic import ConfigDict, Field

from app.api.schemas.alignment import Alignment, Pair, members_of
from app.api.schemas.base import Id, Outgoing, Probability
from app.api.schemas.composed_search import ComposedSearch, ComposedSearchForm, PartScore
from app.api.schemas.views import plain
from app.services.comparison.why import MAX_POINTS, MAX_STEPS, Curve, PoseMatch, Reason, Why

_DIGITS = 4
_HIT = "Id of the clip to explain."


class WhySearch(ComposedSearch):
    """A search by examples and words, and one of its hits."""

    hit: Id = Field(description=_HIT, json_schema_extra={"examples": ["CLIP_ID"]})

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [{"examples": [{"clip_id": "CLIP_ID"}], "hit": "CLIP_ID"}],
        }
    )


class WhySearchForm(ComposedSearchForm):
    """The same with an uploaded file (never stored) as one more example."""

    hit: Id = Field(description=_HIT, json_schema_extra={"examples": ["CLIP_ID"]})


class ExampleAlignment(Alignment):
    """An example (first) and the hit (second) along the path that warps one onto the other."""

    seconds: Pair = Field(
        description="Seconds between two frames of the first and of the second motion that were "
        f"compared: 0.1, and more for a motion of more than {MAX_STEPS} frames."
    )


class WordCurve(Outgoing):
    """How probable words are over the time of a hit."""

    times: list[float] = Field(
        description=f"(points,) seconds, evenly spaced; at most {MAX_POINTS}."
    )
    values: list[Probability] = Field(description="(points,)")


class PoseMoment(Outgoing):
    """When a hit is nearest to a pose of a sequence."""

    time: float = Field(description="Seconds from the start of the hit.")
    distance: float = Field(description="Root mean square distance of the joints, body lengths.")


class HitReason(PartScore):
    """What one part of a query says about a hit."""

    weight: float = Field(
        description="The weight of the part. All words together have 1, in equal shares."
    )
    alignment: ExampleAlignment | None = Field(
        description="Of an example; null for words. It shows which joints and which moments agree "
        "or differ: `differences` is small where they agree."
    )
    curve: WordCurve | None = Field(
        description="Of words: when they are probable, from windows of 2 and 4 s. null for "
        "examples, and for a clip without windows."
    )
    poses: list[PoseMoment] | None = Field(description="Of `poses`: one for each, in their order.")
    cycles_per_minute: float | None = Field(
        description="Of `rhythm`: those of the hit; null if it does not repeat itself."
    )


class HitReasons(Outgoing):
    """Why a clip is a hit."""

    method: str
    clip_id: str
    rank: int | None = Field(
        description="null if the clip is not among the first 300 hits, or does not pass the "
        "filter. Score and distance are then those that it has alone."
    )
    score: float
    distance: float
    parts: list[HitReason]

    @classmethod
    def of(cls, found: Why) -> HitReasons:
        """The reasons as the API shows them."""
        return cls(
            method=found.method,
            clip_id=found.clip.id,
            rank=found.rank,
            score=found.score,
            distance=found.distance,
            parts=[_reason(one) for one in found.reasons],
        )


def _reason(found: Reason) -> HitReason:
    alignment = None
    if found.alignment is not None and found.seconds is not None:
        alignment = ExampleAlignment(
            **members_of(found.alignment), seconds=[round(one, _DIGITS) for one in found.seconds]
        )
    return HitReason(
        part=found.score.part,
        against=found.score.is_against,
        score=found.score.score,
        cost=found.score.cost,
        weight=found.weight,
        alignment=alignment,
        curve=None if found.curve is None else _curve(found.curve),
        poses=None if found.poses is None else [_moment(one) for one in found.poses],
        cycles_per_minute=found.cycles_per_minute,
    )


def _moment(found: PoseMatch) -> PoseMoment:
    return PoseMoment(
        time=round(found.time, _DIGITS),
        distance=round(found.distance, _DIGITS),
    )


def _curve(found: Curve) -> WordCurve:
    return WordCurve(
        times=plain(found.times.round(_DIGITS)), values=plain(found.values.round(_DIGITS))
    )
