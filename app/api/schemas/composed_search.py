"""Searches by several parts: examples and words, for something or against it."""

from __future__ import annotations

import json
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, ConfigDict, Field, Json, field_validator

from app.api.schemas.base import ROUNDED, Cursor, Incoming, Limit, Outgoing, Probability, Seconds
from app.api.schemas.clips import FileFrameRate, FormRoles, Stack, Unit, UpAxis
from app.api.schemas.filters import Filter
from app.api.schemas.search import Confidence, Expanded, Hit, UnknownWords
from app.api.schemas.search_parts import SearchExample, SearchPoses, SearchRhythm, Weight
from app.search.composed.body_parts import BodyPart
from app.search.example.methods import Method
from app.services.find.arrangement import Arrangement, GroupBy
from app.services.find.arranging import MAX_FACETS
from app.services.find.by_parts import MAX_EXAMPLES
from app.services.find.queries import ComposedQuery, Example
from app.services.find.query_source import QuerySource
from app.store.files.files import Readable

FILE = "file"
"""The part of a query that is the uploaded file."""


_Examples = Annotated[list[SearchExample], Field(max_length=MAX_EXAMPLES)]
_Words = Annotated[list[Annotated[str, Field(min_length=1, max_length=300)]], Field(max_length=100)]


def _split(value: Any) -> Any:
    if not isinstance(value, str):
        return value
    if not value.lstrip().startswith("["):
        return value.split()
    try:
        return json.loads(value)
    except RecursionError as error:
        raise ValueError("must be an array of texts") from error


_FormWords = Annotated[_Words, BeforeValidator(_split, json_schema_input_type=str)]
_FormFacets = Annotated[
    Annotated[list[Annotated[str, Field(max_length=100)]], Field(max_length=MAX_FACETS)],
    BeforeValidator(_split, json_schema_input_type=str),
]
_EXAMPLES = "Motions that hits are like, or are not like."
_WORDS = (
    "Words, phrases or sentences, as in a search by words. Together they count like one example "
    "of weight 1. A word with a minus before it (-left) leaves out the clips that carry it."
)


_POSES = "Poses that hits take, one after the other."
_RHYTHM = "A rhythm in which hits move."
_ARRANGED = (
    "With this, `diversity`, `min_score` or `facets`, one part alone is scored as one of several: "
    "by a probability, and one example at its own tempo."
)


class _ComposedOptions(Incoming):
    method: Method = Field(
        Method.FUSED,
        description="How examples are compared. fused, dtw, msv-dtw and msv-xcorr are exact for "
        "the 300 clips that fit best by vectors and words; the others follow in that order. One "
        "example alone is compared with every clip, as in a search by example.",
    )
    mode: Literal["default", "cca", "printed"] = Field(
        "default", description="How clips are ranked by words, as in a search by words."
    )
    limit: Limit = 10
    include_self: bool = Field(False, description="Whether the examples' clips may be hits.")
    poses: SearchPoses | None = Field(None, description=_POSES)
    rhythm: SearchRhythm | None = Field(None, description=_RHYTHM)
    filter: Filter | None = None
    group_by: GroupBy | None = Field(
        None,
        description="Show only the best hit of each group: by person, task, source, or near-"
        f"duplicates (`GET /v1/duplicates`). {_ARRANGED}",
    )
    group: str | None = Field(
        None,
        max_length=300,
        description="With group_by: the hits of this group, by the `value` of an earlier answer.",
    )
    diversity: float = Field(
        0.0,
        ge=0,
        le=1,
        description="Above 0, the 300 best hits are put in an order in which neighbors are unlike "
        "each other (maximal marginal relevance): next is the hit with the largest (1 - diversity) "
        "x score - diversity x likeness to the hits before it. The ranking ends after them.",
    )
    min_score: float = Field(
        0.0, ge=0, le=1, description="Only hits with at least this score, a probability."
    )
    facets: list[Annotated[str, Field(max_length=100)]] = Field(
        default=[],
        max_length=MAX_FACETS,
        description="Count over all hits: person, task, source, license, folder, word, or the "
        "quartiles of a measure by its name (`GET /v1/measures`, or duration, speed, ...).",
    )
    cursor: Cursor | None = None

    def _query(self, examples: list[Example], words: list[str]) -> ComposedQuery:
        return ComposedQuery(
            examples=examples,
            words=words,
            poses=None if self.poses is None else self.poses.part(),
            rhythm=None if self.rhythm is None else self.rhythm.part(),
            method=self.method,
            mode=self.mode,
            limit=self.limit,
            filter=None if self.filter is None else self.filter.given(),
            include_self=self.include_self,
            arrangement=Arrangement(self.group_by, self.group, self.diversity, self.min_score),
            facets=self.facets,
            cursor=self.cursor,
        )


class ComposedSearch(_ComposedOptions):
    """Find motions by examples and words together; one of them must be for something."""

    examples: _Examples = Field(default=[], description=_EXAMPLES)
    words: _Words = Field(default=[], description=_WORDS)

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "examples": [
                        {"clip_id": "CLIP_ID"},
                        {"clip_id": "CLIP_ID", "start": 0.5, "end": 1.5, "weight": 0.5},
                    ],
                    "words": ["-tired"],
                },
            ]
        }
    )

    def query(self) -> ComposedQuery:
        """The search for several parts."""
        examples = [one.part(index) for index, one in enumerate(self.examples)]
        return self._query(examples, self.words)


class ComposedSearchForm(_ComposedOptions):
    """The same with an uploaded file (never stored) as one more example."""

    examples: Json[_Examples] = Field(default=[], description=f"JSON. {_EXAMPLES}")
    words: _FormWords = Field(
        default=[], description=f"A JSON array, or words separated by spaces. {_WORDS}"
    )
    poses: Json[SearchPoses] | None = Field(None, description=f"JSON. {_POSES}")
    rhythm: Json[SearchRhythm] | None = Field(None, description=f"JSON. {_RHYTHM}")
    filter: Json[Filter] | None = Field(None, description='JSON, as {"task": ["walk", "run"]}.')
    facets: _FormFacets = Field(default=[], description="A JSON array, or names with spaces.")
    start: Seconds | None = Field(None, description="Start of the part of the file, seconds.")
    end: Seconds | None = Field(None, description="End of the part of the file, seconds.")
    weight: Weight = 1.0
    against: bool = Field(False, description="Whether hits must not be like the file.")
    body_part: BodyPart | None = Field(None, description="The part of the file's body that counts.")
    unit: Unit = None
    frame_rate: FileFrameRate = None
    up_axis: UpAxis | None = None
    roles: FormRoles = None
    stack: Stack | None = None

    def query(self, content: Readable | None, skeleton: Readable | None) -> ComposedQuery:
        """The search for several parts. content: the file; skeleton: the ASF file of an AMC."""
        examples = [one.part(index) for index, one in enumerate(self.examples)]
        if content is not None:
            source = QuerySource(
                content=content,
                start=self.start,
                end=self.end,
                skeleton=skeleton,
                frame_rate=self.frame_rate,
                unit=self.unit,
                up_axis=self.up_axis,
                roles=self.roles,
                stack=self.stack,
            )
            examples.append(Example(FILE, source, self.weight, self.against, self.body_part))
        return self._query(examples, self.words)


class PartScore(Outgoing):
    """How likely one part of a query is true of a hit."""

    part: str = Field(
        description="The part of the query: `examples.0` for the first example, `file` for the "
        "uploaded one, `poses`, `rhythm`, `words.0` for the first word."
    )
    against: bool = Field(
        validation_alias="is_against", description="Whether the query is against it."
    )
    score: Probability = Field(
        description="Probability that the clip is like the example, or carries the words. For "
        "examples it comes from the distance, relative to the median distance in the library, by "
        f"a curve that was fitted on real clips. {ROUNDED}"
    )
    cost: float = Field(
        ge=0,
        description="What the part adds to the `distance` of the hit: of the 300 clips that are "
        "compared exactly, the costs of all parts sum to the distance. What several examples for "
        "something, or several words, cost together is divided in proportion to -ln(score) of "
        "each.",
    )


class HitGroup(Outgoing):
    """The group of a hit."""

    by: GroupBy
    value: str | None = Field(
        description="Its name, for `group`: the label, or the id of a group of near-duplicates. "
        "An empty text for clips without the label; null for a clip without near-duplicates."
    )
    count: int = Field(description="Number of hits in the group.")


class FacetCount(Outgoing):
    """A value, and the number of hits with it."""

    value: str
    count: int


class Facet(Outgoing):
    """What the hits have of one label or measure."""

    values: list[FacetCount] = Field(
        description="Of a label: the most frequent first, at most 100. Empty for a measure."
    )
    others: int = Field(description="Hits with values that are not listed.")
    missing: int = Field(description="Hits without the label or the measure.")
    quartiles: list[float] | None = Field(
        description="Of a measure: (5,) the least value, the quartiles, and the largest value."
    )

    @field_validator("values", mode="before")
    @classmethod
    def _named(cls, values: Any) -> Any:
        return [
            {"value": one[0], "count": one[1]} if isinstance(one, tuple) else one for one in values
        ]


class ComposedHit(Hit):
    """One hit of a search by several parts."""

    score: float = Field(
        ge=0,
        le=1,
        description="Weighted geometric mean of the probabilities that the clip is of the kind of "
        "the examples for something (the mean of their log odds), that it carries the words, and "
        "that it is not like each example against something. One part alone has the score of its "
        "own search.",
    )
    distance: float = Field(
        description="-ln(score), and a constant more behind the 300 clips that are compared "
        "exactly. One part alone has the distance of its own search."
    )
    parts: list[PartScore] = Field(
        description="What each part says. A word without a meaning in this library is left out."
    )
    group: HitGroup | None = Field(None, description="With group_by: its group.")


class ComposedHits(Outgoing):
    """A page of a ranking by several parts, the best first."""

    method: str = Field(description="The method of the examples; without one, the mode of words.")
    took_ms: float
    library_version: int
    items: list[ComposedHit]
    next: str | None
    facets: dict[str, Facet] | None = Field(
        None, description="By name, over all hits on all pages; null if none was asked for."
    )
    unknown_words: UnknownWords
    expanded: Expanded
    confidence: Confidence
