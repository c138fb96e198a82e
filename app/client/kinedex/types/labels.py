"""Answers: labels. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass

from kinedex.records import Page, Record


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
    """A page of the labels of a kind, by name."""

    items: list[NamedCount]
    next: str | None


@dataclass(frozen=True, slots=True)
class WordSuggestion(Record):
    """A word that the model would give a clip.

    score: Probability that a clip with this motion carries the word. It is calibrated on held-
    out clips, so that scores of different clips and words can be compared.
    """

    word: str
    score: float


@dataclass(frozen=True, slots=True)
class WordSuggestions(Page[WordSuggestion]):
    """Words that a clip does not carry yet, the likeliest first; `next` is always null."""

    items: list[WordSuggestion]
    next: str | None
