"""Answers: annotations. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from kinedex.records import Record


@dataclass(frozen=True, slots=True)
class Annotation(Record):
    """What is said about a part of a clip.

    start: Start of the part, seconds from the start of the clip.
    end: End of the part, seconds.
    words: What happens in the part. A phrase is one word, joined by underscores (`left_leg`).
    person: Who moves in the part, if it is not the person of the clip.
    text: A sentence that describes the part.
    by: Who said it.
    origin: person: somebody made or corrected it. import: it came in a file. suggestion:
    somebody accepted what the models suggested.
    probability: Of an accepted suggestion, how probable the words were.
    """

    id: str
    clip_id: str
    start: float
    end: float
    words: list[str]
    person: str | None
    text: str | None
    by: str | None
    origin: Literal["person", "import", "suggestion"]
    probability: float | None


@dataclass(frozen=True, slots=True)
class SuggestedAnnotation(Record):
    """A part of a clip without annotation, and what the models see there.

    start: Start of the part, seconds from the start of the clip.
    end: End of the part, seconds.
    words: Words that are likelier than not, the likeliest first.
    probability: Of the likeliest word.
    person: Who moves there, if the recognizer knows.
    """

    start: float
    end: float
    words: list[str]
    probability: float
    person: str | None
    person_probability: float | None


@dataclass(frozen=True, slots=True)
class AnnotationSuggestions(Record):
    """Parts of a clip without annotation, by start."""

    items: list[SuggestedAnnotation]


@dataclass(frozen=True, slots=True)
class Annotations(Record):
    """The annotations of a clip, by start."""

    items: list[Annotation]
