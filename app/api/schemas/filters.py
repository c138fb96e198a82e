"""Filters of clips. A search (in its body) and a list (in its query) use the same names."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from app.api.schemas.base import AnyOf, Incoming, Seconds


class Filter(Incoming):
    """Filters of the clips before they are ranked. A clip must pass all given filters."""

    person: AnyOf | None = None
    task: AnyOf | None = None
    word: AnyOf | None = None
    license: AnyOf | None = None
    source: AnyOf | None = None
    not_person: AnyOf | None = Field(None, description="Clips of none of these persons.")
    not_task: AnyOf | None = Field(None, description="Clips of none of these tasks.")
    not_word: AnyOf | None = Field(None, description="Clips with none of these words.")
    not_license: AnyOf | None = Field(None, description="Clips with none of these licenses.")
    not_source: AnyOf | None = Field(None, description="Clips from none of these sources.")
    min_duration: Seconds | None = Field(None, description="Seconds.")
    max_duration: Seconds | None = Field(None, description="Seconds.")

    def given(self) -> dict[str, Any]:
        """Return the sent filters, without other fields of a subclass."""
        values = {name: getattr(self, name) for name in Filter.model_fields}
        return {name: value for name, value in values.items() if value is not None}
