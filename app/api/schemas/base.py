"""Base classes of all schemas, and the types of fields that several schemas share."""

from __future__ import annotations

from typing import Annotated, Any, TypeVar

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field

from app.motion.roles.joint_roles import JointRole
from app.search.index.filters import MAX_LABEL_LENGTH, MAX_LABELS
from app.services import fields
from app.services.views.frame_rates import MAX_FPS, MIN_FPS
from app.store.database.cursor_codec import MAX_CURSOR_LENGTH

Value = TypeVar("Value")


class Incoming(BaseModel):
    """A body or query: unknown fields and numbers that are not finite are refused."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)


class Outgoing(BaseModel):
    """An answer. It shows the fields that its class names and no others.

    `model_validate` builds it from a value that has attributes of the same names. A field with
    `validation_alias` reads the attribute of that name. Its validator is built when it is first
    used: a command calls one route, but imports the schemas of many.
    """

    model_config = ConfigDict(
        extra="forbid", from_attributes=True, validate_by_name=True, defer_build=True
    )


def _as_list(value: Any) -> Any:
    return [value] if isinstance(value, str) else value


def _as_words(value: Any) -> Any:
    return value.split() if isinstance(value, str) else value


def _without_control(value: str) -> str:
    if fields.holds_control(value):
        raise ValueError(fields.NO_CONTROL)
    return value


PartOfName = Annotated[str, Field(max_length=300), AfterValidator(_without_control)]
"""Part of a name, without control characters: SQLite's LIKE ends at a NUL and would match all."""

_Filtered = Annotated[str, Field(min_length=1, max_length=MAX_LABEL_LENGTH)]
_SomeFiltered = Annotated[list[_Filtered], Field(min_length=1, max_length=MAX_LABELS)]
AnyOf = Annotated[
    _SomeFiltered, BeforeValidator(_as_list, json_schema_input_type=_Filtered | _SomeFiltered)
]
"""A label, or a list of accepted labels."""

Label = Annotated[str, Field(max_length=fields.MAX_TEXT)]
"""A name or label of a clip. The service checks further rules (`app.services.fields`)."""

Words = Annotated[list[Label], Field(max_length=fields.MAX_WORDS)]
"""The words of one clip."""

_JoinedWords = Annotated[str, Field(max_length=fields.MAX_WORDS * (fields.MAX_TEXT + 1))]
FormWords = Annotated[Words, BeforeValidator(_as_words, json_schema_input_type=_JoinedWords)]
"""Words of a form, separated by spaces; a phrase is joined by underscores."""

Limit = Annotated[int, Field(ge=1, le=1000, description="Maximum number of items in one answer.")]

Cursor = Annotated[
    str,
    Field(
        max_length=MAX_CURSOR_LENGTH,
        description="`next` of the previous answer. The answer starts there.",
    ),
]
Id = Annotated[str, Field(min_length=1, max_length=100)]
"""The id of a clip or another object."""
Roles = Annotated[
    dict[
        Annotated[str, Field(max_length=30)],
        Annotated[str, Field(min_length=1, max_length=fields.MAX_JOINT_NAME)],
    ],
    Field(max_length=len(JointRole)),
]
"""Joint names by joint role."""
Seconds = Annotated[float, Field(ge=0, le=1e6)]

Fps = Annotated[float, Field(ge=MIN_FPS, le=MAX_FPS)]
"""Frames per second of a resampled motion."""
