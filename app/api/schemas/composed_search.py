"""Searches by several parts: examples and words, for something or against it."""

from __future__ import annotations

import json
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, ConfigDict, Field, Json

from app.api.schemas.base import ROUNDED, Cursor, Incoming, Limit, Outgoing, Probability, Seconds
from app.api.schemas.clips import FileFrameRate, FormRoles, Stack, Unit, UpAxis
from app.api.schemas.filters import Filter
from app.api.schemas.query_source import ClipId
from app.api.schemas.search import Confidence, Expanded, Hit, UnknownWords
from app.search.example.methods import Method
from app.services.find.by_parts import MAX_EXAMPLES, MAX_WEIGHT
from app.services.find.queries import ComposedQuery, Example
from app.services.find.query_source import QuerySource
from app.store.files.files import Readable

FILE = "file"
"""The part of a query that is the uploaded file."""

_Weight = Annotated[
    float, Field(gt=0, le=MAX_WEIGHT, description="How much it counts, relative to the others.")
]


class SearchExample(Incoming):
    """A stored clip, or a part of it, that hits must be like, or must not be like."""

    clip_id: ClipId
    start: Seconds | None = Field(None, description="Start of the part, seconds.")
    end: Seconds | None = Field(None, description="End of the part, seconds.")
    weight: _Weight = 1.0
    against: bool = Field(False, description="Whether hits must not be like it.")

    def part(self, index: int) -> Example:
        """The example at this index of a query."""
        source = QuerySource(clip_id=self.clip_id, start=self.start, end=self.end)
        return Example(f"examples.{index}", source, self.weight, self.against)


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
_EXAMPLES = "Motions that hits are like, or are not like."
_WORDS = (
    "Words, phrases or sentences, as in a search by words. Together they count like one example "
    "of weight 1. A word with a minus before it (-left) leaves out the clips that carry it."
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
    filter: Filter | None = None
    cursor: Cursor | None = None

    def _query(self, examples: list[Example], words: list[str]) -> ComposedQuery:
        return ComposedQuery(
            examples=examples,
            words=words,
            method=self.method,
            mode=self.mode,
            limit=self.limit,
            filter=None if self.filter is None else self.filter.given(),
            include_self=self.include_self,
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
    filter: Json[Filter] | None = Field(None, description='JSON, as {"task": ["walk", "run"]}.')
    start: Seconds | None = Field(None, description="Start of the part of the file, seconds.")
    end: Seconds | None = Field(None, description="End of the part of the file, seconds.")
    weight: _Weight = 1.0
    against: bool = Field(False, description="Whether hits must not be like the file.")
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
            examples.append(Example(FILE, source, self.weight, self.against))
        return self._query(examples, self.words)


class PartScore(Outgoing):
    """How likely one part of a query is true of a hit."""

    part: str = Field(
        description="The part of the query: `examples.0` for the first example, `file` for the "
        "uploaded one, `words.0` for the first word."
    )
    against: bool = Field(
        validation_alias="is_against", description="Whether the query is against it."
    )
    score: Probability = Field(
        description="Probability that the clip is like the example, or carries the words. For "
        "examples it comes from the distance, relative to the median distance in the library, by "
        f"a curve that was fitted on real clips. {ROUNDED}"
    )


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


class ComposedHits(Outgoing):
    """A page of a ranking by several parts, the best first."""

    method: str = Field(description="The method of the examples; without one, the mode of words.")
    took_ms: float
    library_version: int
    items: list[ComposedHit]
    next: str | None
    unknown_words: UnknownWords
    expanded: Expanded
    confidence: Confidence
