"""What is said about a clip: warnings, and differences from what came with its content again."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from app.api.schemas.base import Outgoing


class ClipWarning(Outgoing):
    """A possible error in a clip that can still be used."""

    code: str
    detail: str
    likely: float | None = Field(None, description="The value that is probably right, if any.")
    start: float | None = Field(
        None,
        description="Seconds of the clip: the first doubtful frame, or the worst of several"
        " stretches; null: the doubt is about the whole clip.",
    )
    end: float | None = Field(None, description="Seconds of the clip: the last doubtful frame.")
    joint: str | None = Field(
        None,
        description="The doubtful joint or marker, or the first of them: its name in the file.",
    )


class Difference(Outgoing):
    """A label, hint or key of the metadata that came with content that the library had already."""

    field: str = Field(description="Name of the label or hint; `meta.KEY` for metadata.")
    stored: Any = Field(description="The value in the library before; null: none.")
    sent: Any = Field(description="The other value that came now; null: none.")
    applied: bool = Field(description="Whether `sent` has replaced `stored`.")
