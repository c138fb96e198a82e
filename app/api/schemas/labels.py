"""Persons, tasks and words with their counts."""

from __future__ import annotations

from pydantic import Field

from app.api.schemas.base import (
    ROUNDED,
    Cursor,
    Incoming,
    Limit,
    Outgoing,
    Paged,
    PartOfName,
    Path,
    Probability,
    Words,
)
from app.store.clips.metadata_values import ValueKind


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


class ValueCount(Outgoing):
    """A value, and the number of clips that have it."""

    value: bool | int | float | str
    count: int


class MetadataKey(Outgoing):
    """A key of the metadata in this library."""

    name: str = Field(description="Filter by it with `meta.NAME`.")
    count: int = Field(ge=0, description="Clips that have it.")
    kinds: dict[ValueKind, int] = Field(description="Number of clips by the kind of their value.")
    minimum: float | None = Field(description="Of the numbers; null without any.")
    maximum: float | None = Field(description="Of the numbers; null without any.")
    values: list[ValueCount] = Field(description="The most frequent values, at most 10.")


class MetadataKeys(Outgoing):
    """A page of the keys of the metadata, by name."""

    items: list[MetadataKey]
    next: str | None = None


class FolderQuery(LabelPage):
    """A folder, and a page of the folders in it."""

    folder: Path | None = Field(None, description="Default: the root.")


class Folder(Outgoing):
    """A folder in which files of imported clips were."""

    name: str
    path: str = Field(description="Filter by it with `folder`.")
    clips: int = Field(ge=0, description="Clips in it and below it.")
    subfolders: int = Field(ge=0, description="Folders directly in it.")


class FolderList(Outgoing):
    """A page of the folders in a folder, by name."""

    items: list[Folder]
    next: str | None = None


WORD_SCORE = (
    "Probability that a clip with this motion carries the word. It is calibrated on held-out "
    f"clips, so that scores of different clips and words can be compared. {ROUNDED}"
)


class WordSuggestion(Outgoing):
    """A word that the model would give a clip."""

    word: str
    score: Probability = Field(description=WORD_SCORE)


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
