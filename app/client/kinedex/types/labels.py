"""Answers: labels. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass

from kinedex.records import Page, Record


@dataclass(frozen=True, slots=True)
class Folder(Record):
    """A folder in which files of imported clips were.

    path: Filter by it with `folder`.
    clips: Clips in it and below it.
    subfolders: Folders directly in it.
    """

    name: str
    path: str
    clips: int
    subfolders: int


@dataclass(frozen=True, slots=True)
class FolderList(Page[Folder]):
    """A page of the folders in a folder, by name."""

    items: list[Folder]
    next: str | None


@dataclass(frozen=True, slots=True)
class ValueCount(Record):
    """A value, and the number of clips that have it."""

    value: bool | int | float | str
    count: int


@dataclass(frozen=True, slots=True)
class MetadataKey(Record):
    """A key of the metadata in this library.

    name: Filter by it with `meta.NAME`.
    count: Clips that have it.
    kinds: Number of clips by the kind of their value.
    minimum: Of the numbers; null without any.
    maximum: Of the numbers; null without any.
    values: The most frequent values, at most 10.
    """

    name: str
    count: int
    kinds: dict[str, int]
    minimum: float | None
    maximum: float | None
    values: list[ValueCount]


@dataclass(frozen=True, slots=True)
class MetadataKeys(Page[MetadataKey]):
    """A page of the keys of the metadata, by name."""

    items: list[MetadataKey]
    next: str | None


@dataclass(frozen=True, slots=True)
class NamedCount(Record):
    """A label, and the number of clips in any state that carry it.

    count: Recorded clips.
    synthesized: Stored clips from POST /v1/synthesize. `count` does not include them.
    """

    name: str
    count: int
    synthesized: int


@dataclass(frozen=True, slots=True)
class NamedCounts(Page[NamedCount]):
    """A page of the labels of a kind, by name. Of completions there is one page.

    next: Cursor of the next page, null on the last page.
    total: Number of items on all pages.
    total_is_exact: False if `total` is an estimate, as in lists of over 100,000 items. Its
    standard deviation is 1 %.
    """

    next: str | None
    total: int
    total_is_exact: bool
    items: list[NamedCount]


@dataclass(frozen=True, slots=True)
class WordSuggestion(Record):
    """A word that the model would give a clip.

    score: Probability that a clip with this motion carries the word. It is calibrated on held-
    out clips, so that scores of different clips and words can be compared. Rounded to 4
    decimals, because the calibration is not more exact. 0 means very unlikely, not impossible.
    """

    word: str
    score: float


@dataclass(frozen=True, slots=True)
class WordSuggestions(Page[WordSuggestion]):
    """Words that a clip does not carry yet, the likeliest first; `next` is always null."""

    items: list[WordSuggestion]
    next: str | None
