"""Filters of clips. A search (in its body) and a list (in its query) use the same names."""

from __future__ import annotations

import json
from typing import Annotated, Any, Self

from pydantic import (
    BeforeValidator,
    ConfigDict,
    Field,
    ModelWrapValidatorHandler,
    PrivateAttr,
    WithJsonSchema,
    model_validator,
)
from pydantic.config import JsonDict

from app.api.schemas.base import ENERGY, SPEED, TEMPO, TRAVEL, AnyOf, Incoming, Measure, Seconds
from app.search.index.filters import (
    MAX_DEPTH,
    MAX_FILTERS,
    MEASURE_PATTERN,
    META_PATTERN,
    is_open_key,
)

_VALUE: JsonDict = {"type": ["string", "number", "boolean"], "maxLength": 300}
_KINDS = "Kinds of it too, as of a word (`/v1/labels/tree`); none with = before it."
_META: JsonDict = {
    "description": "Metadata: `meta.KEY` and `not_meta.KEY` are a value or a list of values;"
    " `meta.KEY.min` and `meta.KEY.max` are numbers, both ends included.",
    "anyOf": [_VALUE, {"type": "array", "items": _VALUE, "maxItems": 100}],
}

_WHERE = (
    'A tree of filters, as JSON: {"any_of": [{"task": "walk"}, {"none_of": '
    '[{"person": "ada"}]}]}. `all_of`, `any_of` and `none_of` are arrays of filters with the '
    f"keys of this one; at most {MAX_DEPTH} inside each other, and {MAX_FILTERS} in all."
)


def _tree(value: Any) -> Any:
    """A tree of filters from an object, or from its JSON text."""
    try:
        tree = json.loads(value) if isinstance(value, str) else value
    except (ValueError, RecursionError):
        tree = None
    if isinstance(tree, dict):
        return tree
    raise ValueError("must be a JSON object")


Where = Annotated[
    Any,
    BeforeValidator(_tree),
    WithJsonSchema(
        {
            "anyOf": [
                {"type": "object", "additionalProperties": True, "maxProperties": 100},
                {"type": "string", "maxLength": 20_000},
            ]
        }
    ),
]
Time = Annotated[str, Field(max_length=40)]

_BOUND: JsonDict = {"description": "A bound of a measure, included.", "type": "number"}


class Filter(Incoming):
    """Filters of the clips before they are ranked. A clip must pass all given filters.

    `meta.KEY=VALUE` filters by the metadata of the clips, `not_meta.KEY=VALUE` leaves clips with
    that value out, and `meta.KEY.min=30`, `meta.KEY.max=40` filter by a number.
    `measure.NAME.min` and `measure.NAME.max` are bounds of a measure of `GET /v1/measures`, as in
    `measure.foot_skate.max=0.1`.
    """

    model_config = ConfigDict(
        json_schema_extra={"patternProperties": {META_PATTERN: _META, MEASURE_PATTERN: _BOUND}}
    )

    _metadata: dict[str, Any] = PrivateAttr(default_factory=dict)

    person: AnyOf | None = None
    task: AnyOf | None = Field(None, description=_KINDS)
    word: AnyOf | None = None
    license: AnyOf | None = None
    source: AnyOf | None = None
    not_person: AnyOf | None = Field(None, description="Clips of none of these persons.")
    not_task: AnyOf | None = Field(None, description="Clips of none of these tasks.")
    not_word: AnyOf | None = Field(None, description="Clips with none of these words.")
    not_license: AnyOf | None = Field(None, description="Clips with none of these licenses.")
    not_source: AnyOf | None = Field(None, description="Clips from none of these sources.")
    folder: AnyOf | None = Field(
        None, description="Clips whose files were in this folder of an import, or below it."
    )
    not_folder: AnyOf | None = Field(None, description="Clips of none of these folders.")
    collection: AnyOf | None = Field(None, description="Ids of collections: clips in any of them.")
    annotation: AnyOf | None = Field(
        None, description="Words: clips with an annotation that has any of them, or a kind of it."
    )
    created_after: Time | None = Field(
        None, description="Clips that came at this time or later, ISO 8601; UTC without a zone."
    )
    created_before: Time | None = Field(None, description="Clips that came before this time.")
    where: Where | None = Field(None, description=_WHERE)
    min_duration: Seconds | None = Field(None, description="Seconds.")
    max_duration: Seconds | None = Field(None, description="Seconds.")
    min_frame_rate: Measure | None = Field(None, description="Frames per second.")
    max_frame_rate: Measure | None = Field(None, description="Frames per second.")
    min_joints: Measure | None = Field(None, description="Number of joints.")
    max_joints: Measure | None = Field(None, description="Number of joints.")
    min_travel: Measure | None = Field(None, description=TRAVEL)
    max_travel: Measure | None = Field(None, description=TRAVEL)
    min_speed: Measure | None = Field(None, description=SPEED)
    max_speed: Measure | None = Field(None, description=SPEED)
    min_energy: Measure | None = Field(None, description=ENERGY)
    max_energy: Measure | None = Field(None, description=ENERGY)
    min_tempo: Measure | None = Field(None, description=TEMPO)
    max_tempo: Measure | None = Field(None, description=TEMPO)

    @model_validator(mode="wrap")
    @classmethod
    def _with_metadata(cls, data: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        """Keep the conditions on metadata apart: their names are not known in advance."""
        if not isinstance(data, dict):
            return handler(data)
        conditions = {name: value for name, value in data.items() if is_open_key(name)}
        model = handler({name: value for name, value in data.items() if name not in conditions})
        model._metadata = conditions
        return model

    def given(self) -> dict[str, Any]:
        """Return the sent filters, without other fields of a subclass."""
        values = {name: getattr(self, name) for name in Filter.model_fields}
        sent = {name: value for name, value in values.items() if value is not None}
        return sent | self._metadata
