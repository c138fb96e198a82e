"""What all schemas share: strictness of what comes in, the list shape of what goes out."""

from __future__ import annotations

from typing import Annotated, Any, TypeVar

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field

from app.services import fields
from app.services.frame_rates import LEAST_FPS, MOST_FPS

Value = TypeVar("Value")


class Incoming(BaseModel):
    """A body or query: unknown fields and numbers that are not finite are refused."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)


class Outgoing(BaseModel):
    """An answer, built from fields named one by one."""

    model_config = ConfigDict(extra="forbid")


def _as_list(value: Any) -> Any:
    return [value] if isinstance(value, str) else value


def _as_words(value: Any) -> Any:
    return value.split() if isinstance(value, str) else value


def _without_control(value: str) -> str:
    if fields.holds_control(value):
        raise ValueError(fields.NO_CONTROL)
    return value


PartOfName = Annotated[str, Field(max_length=300), AfterValidator(_without_control)]
"""What was typed of a name; SQLite's LIKE would end at a NUL, and so find everything."""

AnyOf = Annotated[
    list[Annotated[str, Field(min_length=1, max_length=300)]],
    BeforeValidator(_as_list, json_schema_input_type=str | list[str]),
    Field(min_length=1, max_length=100),
]
"""A label, or several of which any will do."""

FormWords = Annotated[list[str], BeforeValidator(_as_words, json_schema_input_type=str)]
"""Words of a form, separated by spaces; a phrase is joined by underscores."""

Limit = Annotated[int, Field(ge=1, le=1000, description="Most items in one answer.")]

Cursor = Annotated[
    str, Field(max_length=1000, description="`next` of the answer before; from there on.")
]
Seconds = Annotated[float, Field(ge=0, le=1e6)]

Fps = Annotated[float, Field(ge=LEAST_FPS, le=MOST_FPS)]
"""Frames a second that a motion is resampled to."""
