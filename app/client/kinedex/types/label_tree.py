"""Answers: label tree. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass

from kinedex.records import Record
from kinedex.types.choices import LinkKind


@dataclass(frozen=True, slots=True)
class LabelNode(Record):
    """A task or a word of the library, or a broader one that stands above some of them.

    name: In lower case, with underscores for spaces.
    parent: Of what it is a kind; null: of nothing.
    because: people: somebody said so. phrase: the parent is the head of the phrase. inflection:
    the parent is the base form. lexicon: the parent has the same or a broader meaning. null: it
    has no parent.
    tasks: Clips whose task it is.
    tasks_below: Clips whose task it is, or a kind of it.
    words: Clips with this word.
    """

    name: str
    parent: str | None
    because: LinkKind | None
    tasks: int
    tasks_below: int
    words: int


@dataclass(frozen=True, slots=True)
class LabelTreeAnswer(Record):
    """The tree of labels, by name."""

    items: list[LabelNode]
