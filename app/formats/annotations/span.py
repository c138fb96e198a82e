"""A span: what somebody said about a part of a motion, as files hold it."""

from __future__ import annotations

from dataclasses import dataclass

MAX_SPANS = 10_000
"""Spans of one clip in one file."""
MAX_FILE_BYTES = 16 * 2**20
"""The largest file of annotations."""
DECIMALS = 3
"""Times are milliseconds, because ELAN's are."""
PHRASE, SPACE = "_", " "


@dataclass(frozen=True, slots=True)
class Span:
    """A part of a motion: start and end in seconds, and what is said about it.

    words: as in the file; text: a sentence; by: who said it; place: where it is in the file.
    """

    start: float
    end: float
    words: tuple[str, ...] = ()
    person: str | None = None
    text: str | None = None
    by: str | None = None
    place: str = ""


def as_phrase(text: str) -> str:
    """A text of several words as one word, joined by underscores."""
    return PHRASE.join(text.split())
