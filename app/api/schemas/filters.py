"""Filters of clips: the same names in the body of a search and in the query of a list."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from app.api.schemas.base import AnyOf, Incoming, Seconds


class Filter(Incoming):
    """What narrows a search before anything is ranked; all that are given must hold."""

    person: AnyOf | None = None
    task: AnyOf | None = None
    word: AnyOf | None = None
    license: AnyOf | None = None
    source: AnyOf | None = None
    not_person: AnyOf | None = Field(None, description="None of these persons.")
    not_task: AnyOf | None = Field(None, description="None of these tasks.")
    not_word: AnyOf | None = Field(None, description="Carrying none of these words.")
    not_license: AnyOf | None = Field(None, description="None of these licenses.")
    not_source: AnyOf | None = Field(None, description="None of these sources.")
    min_duration: Seconds | None = Field(None, description="Seconds.")
    max_duration: Seconds | None = Field(None, description="Seconds.")

    def given(self) -> dict[str, Any]:
        """The conditions that were sent, without the other fields of a subclass."""
        values = {name: getattr(self, name) for name in Filter.model_fields}
        return {name: value for name, value in values.items() if value is not None}
