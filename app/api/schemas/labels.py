"""Persons, tasks and words with their counts."""

from __future__ import annotations

from pydantic import Field

from app.api.schemas.base import Cursor, Incoming, Limit, Outgoing, PartOfName, Words


class NamedCount(Outgoing):
    """A label and how many clips carry it, whatever their state."""

    name: str
    count: int = Field(ge=0, validation_alias="recordings", description="Clips of what people did.")
    synthesized: int = Field(
        ge=0, description="Clips besides that were made by POST /v1/synthesize and kept."
    )


class NamedCounts(Outgoing):
    """A page of the labels of a kind, by name."""

    items: list[NamedCount]
    next: str | None = None


class WordBeginning(Incoming):
    """What was typed of a word."""

    q: PartOfName | None = Field(
        None,
        description="Only words that begin with this, or hold it, else those that it is a form of.",
    )
    limit: Limit | None = Field(
        None, description="Default: 10 completions of `q`, or 1,000 words where it is not sent."
    )
    cursor: Cursor | None = Field(None, description="`next` of the answer before, without `q`.")


class LabelPage(Incoming):
    """Which page of the labels."""

    limit: Limit = 1000
    cursor: Cursor | None = None


WORD_SCORE = (
    "Probability that a clip of such a motion carries the word, learned on clips that were held "
    "out: comparable between clips and between words."
)


class WordSuggestion(Outgoing):
    """A word that the model would give a clip."""

    word: str
    score: float = Field(ge=0, le=1, description=WORD_SCORE)


class WordSuggestions(Outgoing):
    """Words that a clip does not carry yet, the likeliest first; `next` is always null."""

    items: list[WordSuggestion]
    next: str | None = None

    @classmethod
    def of(cls, found: tuple[tuple[str, float], ...]) -> WordSuggestions:
        """Suggestions as they go over the wire."""
        return cls(items=[WordSuggestion(word=word, score=score) for word, score in found])


class AcceptedWords(Incoming):
    """Which suggestions are right."""

    words: Words | None = Field(
        None,
        description="Words to add to the clip's; by default all suggestions likelier than not.",
    )
