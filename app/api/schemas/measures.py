"""Measures of clips: definitions, quantiles of the library, and values with percentiles."""

from __future__ import annotations

from pydantic import Field

from app.api.schemas.base import Outgoing
from app.api.schemas.clips import Clip


class MeasureSummary(Outgoing):
    """A measure of clips, and its values in the library."""

    name: str = Field(description="Sort by it with `sort`, filter by `measure.NAME.min` and .max.")
    unit: str
    definition: str = Field(validation_alias="text")
    is_fault: bool = Field(description="Whether large values speak against the recording.")
    count: int = Field(ge=0, description="Clips that have it.")
    quantiles: list[float] = Field(
        description="Deciles of the library: 11 numbers from the least to the largest value; empty"
        " if no clip has the measure."
    )
    counts: list[int] = Field(
        description="How many of the clips that pass the filter lie in each tenth of the library,"
        " from the lowest to the highest. A value at a decile counts in the tenth above."
    )


class MeasureList(Outgoing):
    """All measures."""

    items: list[MeasureSummary]


class MeasuredValue(Outgoing):
    """A measure of one clip."""

    value: float | None = Field(description="null if the clip does not have it.")
    unit: str
    percentile: float | None = Field(
        ge=0,
        le=100,
        description="Percentage of the library's clips with a smaller value; equal values count"
        " by half.",
    )


class MeasuredClip(Clip):
    """A clip with its measures."""

    measures: dict[str, MeasuredValue] = Field(
        description="By name; `GET /v1/measures` defines them."
    )
