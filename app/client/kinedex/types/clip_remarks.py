"""Answers: clip remarks. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from kinedex.records import Record


@dataclass(frozen=True, slots=True)
class ClipWarning(Record):
    """A possible error in a clip that can still be used.

    likely: The value that is probably right, if any.
    start: Seconds of the clip: the first doubtful frame, or the worst of several stretches;
    null: the doubt is about the whole clip.
    end: Seconds of the clip: the last doubtful frame.
    joint: The doubtful joint or marker, or the first of them: its name in the file.
    """

    code: str
    detail: str
    likely: float | None
    start: float | None
    end: float | None
    joint: str | None


@dataclass(frozen=True, slots=True)
class Difference(Record):
    """A label, hint or key of the metadata that came with content that the library had already.

    field: Name of the label or hint; `meta.KEY` for metadata.
    stored: The value in the library before; null: none.
    sent: The other value that came now; null: none.
    applied: Whether `sent` has replaced `stored`.
    """

    field: str
    stored: Any
    sent: Any
    applied: bool
