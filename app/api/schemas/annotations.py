"""Annotations of clips in time, as the API takes and shows them."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import ConfigDict, Field

from app.api.schemas.base import Incoming, Label, Outgoing, Probability, Seconds, Words, not_null
from app.services.annotations.checks import MAX_ANNOTATIONS
from app.services.annotations.files import AnnotationFormat

START = "Start of the part, seconds from the start of the clip."
END = "End of the part, seconds."
WORDS = "What happens in the part. A phrase is one word, joined by underscores (`left_leg`)."
PERSON = "Who moves in the part, if it is not the person of the clip."
TEXT = "A sentence that describes the part."
BY = "Who said it."


class NewAnnotation(Incoming):
    """What is said about a part of a clip. It has words, a person or a text."""

    start: Seconds = Field(description=START)
    end: Seconds = Field(description=END)
    words: Words = Field([], description=WORDS)
    person: Label | None = Field(None, description=PERSON)
    text: Label | None = Field(None, description=TEXT)
    by: Label | None = Field(None, description=BY)

    model_config = ConfigDict(
        json_schema_extra={"examples": [{"start": 0.2, "end": 0.9, "words": ["kick", "right"]}]}
    )


class AnnotationPatch(Incoming):
    """A correction of an annotation. What is left out stays."""

    start: Seconds | None = Field(None, description=START, json_schema_extra=not_null)
    end: Seconds | None = Field(None, description=END, json_schema_extra=not_null)
    words: Words | None = Field(None, description=WORDS)
    person: Label | None = Field(None, description=PERSON)
    text: Label | None = Field(None, description=TEXT)
    by: Label | None = Field(None, description=BY)

    model_config = ConfigDict(json_schema_extra={"examples": [{"words": ["kick", "left"]}]})


class AnnotationsSent(Incoming):
    """All annotations of a clip. They replace earlier ones; an empty list deletes them."""

    items: list[NewAnnotation] = Field(max_length=MAX_ANNOTATIONS)

    def values(self) -> list[dict[str, Any]]:
        """The annotations by the names of their fields."""
        return [one.model_dump() for one in self.items]


class Annotation(Outgoing):
    """What is said about a part of a clip."""

    id: str
    clip_id: str
    start: float = Field(description=START)
    end: float = Field(description=END)
    words: list[str] = Field(description=WORDS)
    person: str | None = Field(description=PERSON)
    text: str | None = Field(description=TEXT)
    by: str | None = Field(description=BY)
    origin: Literal["person", "import", "suggestion"] = Field(
        description="person: somebody made or corrected it. import: it came in a file. suggestion: "
        "somebody accepted what the models suggested."
    )
    probability: Probability | None = Field(
        description="Of an accepted suggestion, how probable the words were."
    )


class Annotations(Outgoing):
    """The annotations of a clip, by start."""

    items: list[Annotation]


class AnnotationFileQuery(Incoming):
    """The format of a file of annotations."""

    format: AnnotationFormat = Field(
        AnnotationFormat.CSV,
        description="csv: a table with the columns clip, start, end, words, person, text and by. "
        "eaf: ELAN, with the tiers words, person, text and by. babel: JSON of BABEL.",
    )


class AnnotationFileForm(AnnotationFileQuery):
    """A file of annotations that a client sends."""


class SuggestedAnnotation(Outgoing):
    """A part of a clip without annotation, and what the models see there."""

    start: float = Field(description=START)
    end: float = Field(description=END)
    words: list[str] = Field(description="Words that are likelier than not, the likeliest first.")
    probability: Probability = Field(description="Of the likeliest word.")
    person: str | None = Field(description="Who moves there, if the recognizer knows.")
    person_probability: Probability | None


class AnnotationSuggestions(Outgoing):
    """Parts of a clip without annotation, by start."""

    items: list[SuggestedAnnotation]


class AcceptedSpan(Incoming):
    """The part of a suggestion that is accepted."""

    start: Seconds = Field(description=START)
    end: Seconds = Field(description=END)


class AcceptedSuggestions(Incoming):
    """The suggestions to accept; without `items`, all of them."""

    items: list[AcceptedSpan] | None = Field(
        None,
        max_length=MAX_ANNOTATIONS,
        description="Start and end of suggestions, as the list of suggestions has them.",
    )
    by: Label | None = Field(None, description="Who accepts them.")
