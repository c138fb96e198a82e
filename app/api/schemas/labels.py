"""Persons, tasks and words with their counts."""

from __future__ import annotations

from pydantic import Field

from app.api.schemas.base import Cursor, Incoming, Limit, Outgoing, Paged, PartOfName, Words


class NamedCount(Outgoing):
    """A label, and the number of clips in any state that carry it."""

    name: str
    count: int = Field(ge=0, validation_alias="recordings", description="Recorded clips.")
    synthesized: int = Field(
        ge=0, description="Stored clips from POST /v1/synthesize. `count` does not include them."
    )


class NamedCounts(Paged):
    """A page of the labels of a kind, by name. Of completions there is one page."""

    items: list[NamedCount]


class WordListQuery(Incoming):
    """The beginning of a word to complete, or a page of all words."""

    q: PartOfName | None = Field(
        None,
        description="Only words that begin with this or hold it, or else words of which it "
        "is a form.",
    )
    limit: Limit | None = Field(
        None, description="Default: 10 completions of `q`, or 1,000 words without `q`."
    )
    cursor: Cursor | None = Field(None, description="`next` of the previous answer. Not with `q`.")


class LabelPage(Incoming):
    """A page of the labels."""

    limit: Limit = 1000
    cursor: Cursor | None = None


WORD_SCORE = (
    "Probability that a clip with this motion carries the word. It is calibrated on held-out "
    "clips, so that scores of different clips and words can be compared."
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
    def of(cls, suggested: tuple[tuple[str, float], ...]) -> WordSuggestions:
        """The suggestions as the API shows them."""
        return cls(items=[WordSuggestion(word=word, score=score) for word, score in suggested])


class AcceptedWords(Incoming):
    """The suggestions that a user accepts."""

    words: Words | None = Field(
        None,
        description="Words to add to the clip. Default: all suggestions that are likelier "
        "than not.",
    )
