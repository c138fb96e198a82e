"""Base classes of all schemas, and the types of fields that several schemas share."""

from __future__ import annotations

from typing import Annotated, Any, Self, TypeVar

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ModelWrapValidatorHandler,
    StrictBool,
    StrictFloat,
    StrictInt,
    ValidationError,
    model_validator,
)

from app.api.schemas.near_names import with_near_names
from app.motion.roles.joint_roles import JointRole
from app.motion.roles.roles import MAX_JOINTS_OF_MIDDLE
from app.search.index.filters import MAX_LABEL_LENGTH, MAX_LABELS
from app.services import clip_fields, fields
from app.services.views.frame_rates import MAX_FPS, MIN_FPS
from app.store.database.cursor_codec import MAX_CURSOR_LENGTH
from app.store.database.totals import MAX_EXACT

Value = TypeVar("Value")


class Incoming(BaseModel):
    """A body or query: unknown fields and numbers that are not finite are refused."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)

    @model_validator(mode="wrap")
    @classmethod
    def _name_the_nearest_field(cls, data: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        """Say which field an unknown one may stand for."""
        try:
            return handler(data)
        except ValidationError as error:
            raise with_near_names(error, cls.model_fields) from None


class Outgoing(BaseModel):
    """An answer. It shows the fields that its class names and no others.

    `model_validate` builds it from a value that has attributes of the same names. A field with
    `validation_alias` reads the attribute of that name. Its validator is built when it is first
    used: a command calls one route, but imports the schemas of many.
    """

    model_config = ConfigDict(
        extra="forbid", from_attributes=True, validate_by_name=True, defer_build=True
    )


class Paged(Outgoing):
    """What every page of a list has besides its items."""

    next: str | None = Field(description="Cursor of the next page, null on the last page.")
    total: int = Field(ge=0, description="Number of items on all pages.")
    total_is_exact: bool = Field(
        description=f"False if `total` is an estimate, as in lists of over {MAX_EXACT:,} items. "
        "Its standard deviation is 1 %."
    )


def not_null(schema: dict[str, Any]) -> None:
    """`json_schema_extra` of a field that is left out if it has no value, and not sent as null."""
    (kind,) = (one for one in schema.pop("anyOf") if one != {"type": "null"})
    schema.pop("default")
    schema.update(kind)


def _as_list(value: Any) -> Any:
    return [value] if isinstance(value, str) else value


def _split_commas(value: Any) -> Any:
    """Split each of the texts of a list, as a query has it."""
    if not isinstance(value, list) or not all(isinstance(one, str) for one in value):
        return value
    return [name for one in value for part in one.split(",") if (name := part.strip())]


def _as_words(value: Any) -> Any:
    return value.split() if isinstance(value, str) else value


def _as_captions(value: Any) -> Any:
    return fields.CAPTION_ENDS.split(value) if isinstance(value, str) else value


def _without_control(value: str) -> str:
    if fields.holds_control(value):
        raise ValueError(fields.NO_CONTROL)
    return value


_CONTROL = r"\u0000-\u001f\u007f-\u009f"
PRINTABLE: dict[str, Any] = {"pattern": f"^[^{_CONTROL}]*$"}
"""The schema of a text without control characters. The check itself has a clearer message."""
NAMED: dict[str, Any] = {"pattern": rf"^[^{_CONTROL}]*[^\s{_CONTROL}][^{_CONTROL}]*$"}
"""The schema of such a text that is also more than spaces."""
PartOfName = Annotated[
    str, Field(max_length=300, json_schema_extra=PRINTABLE), AfterValidator(_without_control)
]
"""Part of a name, without control characters: SQLite's LIKE ends at a NUL and would match all."""

_Filtered = Annotated[str, Field(min_length=1, max_length=MAX_LABEL_LENGTH)]
_SomeFiltered = Annotated[list[_Filtered], Field(min_length=1, max_length=MAX_LABELS)]
AnyOf = Annotated[
    _SomeFiltered, BeforeValidator(_as_list, json_schema_input_type=_Filtered | _SomeFiltered)
]
"""A label, or a list of accepted labels."""

Label = Annotated[str, Field(max_length=fields.MAX_TEXT, json_schema_extra=PRINTABLE)]
"""A name or label of a clip. The service checks further rules (`app.services.clip_fields`)."""

Path = Annotated[
    str,
    Field(max_length=fields.MAX_PATH, json_schema_extra=PRINTABLE),
    AfterValidator(_without_control),
]
"""A path of a file or folder, with / between its parts."""

_MetadataKey = Annotated[str, Field(min_length=1, max_length=clip_fields.MAX_META_KEY)]
Metadata = dict[str, bool | int | float | str]
"""Metadata of a clip as it is shown."""
MetadataChanges = Annotated[
    dict[_MetadataKey, StrictBool | StrictInt | StrictFloat | Label | None],
    Field(max_length=clip_fields.MAX_META_KEYS, examples=[{"condition": "fatigued", "age": 30}]),
]
"""Metadata that a client sends. The service checks further rules (`app.services.clip_fields`)."""

Words = Annotated[list[Label], Field(max_length=fields.MAX_WORDS)]
"""The words of one clip."""

_JoinedWords = Annotated[str, Field(max_length=fields.MAX_WORDS * (fields.MAX_TEXT + 1))]
FormWords = Annotated[Words, BeforeValidator(_as_words, json_schema_input_type=_JoinedWords)]
"""Words of a form, separated by spaces; a phrase is joined by underscores."""

Captions = Annotated[list[Label], Field(max_length=fields.MAX_CAPTIONS)]
"""The captions of one clip."""

_JoinedCaptions = Annotated[str, Field(max_length=fields.MAX_CAPTIONS * (fields.MAX_TEXT + 1))]
FormCaptions = Annotated[
    Captions, BeforeValidator(_as_captions, json_schema_input_type=_JoinedCaptions)
]
"""Captions of a form, one a line."""

Limit = Annotated[int, Field(ge=1, le=1000, description="Maximum number of items in one answer.")]

MAX_FIELDS, MAX_FIELD_NAME = 60, 60
Fields = Annotated[
    list[Annotated[str, Field(max_length=MAX_FIELD_NAME)]],
    BeforeValidator(_split_commas),
    Field(
        min_length=1,
        max_length=MAX_FIELDS,
        description="Members of each item, with commas between them, as in `id,name`; of the clip "
        "of a hit as in `score,clip.id`. Default: all. Other members are then left out, even if "
        "the schema of the answer requires them.",
    ),
]
"""The members that a client chose (`app.api.sparse`)."""

Cursor = Annotated[
    str,
    Field(
        max_length=MAX_CURSOR_LENGTH,
        description="`next` of the previous answer. The answer starts there.",
    ),
]
Id = Annotated[str, Field(min_length=1, max_length=100)]
"""The id of a clip or another object."""
_JointName = Annotated[str, Field(min_length=1, max_length=fields.MAX_JOINT_NAME)]
_TwoJoints = Annotated[list[_JointName], Field(min_length=1, max_length=MAX_JOINTS_OF_MIDDLE)]
Roles = Annotated[
    dict[Annotated[str, Field(max_length=30)], _JointName | _TwoJoints],
    Field(max_length=len(JointRole)),
]
"""Joint names by joint role. Two names are for the middle of two joints."""
Seconds = Annotated[float, Field(ge=0, le=1e6)]
Measure = Annotated[float, Field(ge=0, le=1e6)]
"""A bound of a measure in a filter."""

TRAVEL = "Meters that the hips travel over the floor, forth and back."
SPEED = "Mean speed of the hips over the floor, meters per second."
ENERGY = "Mean energy: root mean square speed of the joints, body lengths per second."
TEMPO = "Beats per minute."
"""What the measures of a clip mean."""

PROBABILITY_DIGITS = 4
"""Decimals of a probability. No calibration on held-out clips can justify more."""
ROUNDED = (
    f"Rounded to {PROBABILITY_DIGITS} decimals, because the calibration is not more exact. 0 means "
    "very unlikely, not impossible."
)
"""The end of the description of a Probability."""
Probability = Annotated[
    float, Field(ge=0, le=1), AfterValidator(lambda value: round(value, PROBABILITY_DIGITS))
]
"""A probability in an answer, with ROUNDED in its description."""

Fps = Annotated[float, Field(ge=MIN_FPS, le=MAX_FPS)]
"""Frames per second of a resampled motion."""
