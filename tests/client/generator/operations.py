"""The operations of an OpenAPI description: their parameters, bodies and answers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from tests.client.generator.names import MethodName, method_name
from tests.client.generator.schemas import PREFIX, Schema, name_of

JSON, FORM = "application/json", "multipart/form-data"
OCTETS, EVENTS = "application/octet-stream", "text/event-stream"
VERBS = ("get", "post", "put", "patch", "delete")
FILTERS = (
    'Filters by name, as in a search, for those that are no arguments: {"meta.condition": "tired", '
    '"meta.age.min": 30}.'
)


@dataclass(frozen=True)
class Parameter:
    """A parameter of a method.

    place: path, query, json, form, both, file, or filter: more parameters of the query, by name.
    """

    name: str
    schema: Schema
    is_required: bool
    place: str

    @property
    def description(self) -> str:
        return str(self.schema.get("description", ""))


@dataclass(frozen=True)
class Operation:
    """One call of the API.

    body: the kinds of its body (json, form). is_optional_body: it may come without a body.
    """

    id: str
    method: str
    path: str
    name: MethodName
    summary: str
    parameters: tuple[Parameter, ...]
    body: tuple[str, ...]
    answers: Mapping[str, Mapping[str, Schema]]
    is_optional_body: bool = False

    def answer_types(self) -> set[str]:
        """The media types of its successful answers."""
        return {kind for answer in self.answers.values() for kind in answer}

    def answer_model(self) -> str | None:
        """The component that its JSON answer is."""
        for answer in self.answers.values():
            if "$ref" in answer.get(JSON, {}):
                return name_of(answer[JSON]["$ref"])
        return None


def operations(description: Mapping[str, Any]) -> Iterator[Operation]:
    """All operations of the description."""
    for path, methods in description["paths"].items():
        for method in VERBS:
            if method in methods:
                yield _operation(path, method, methods[method], description)


def _operation(path: str, method: str, one: Schema, description: Mapping[str, Any]) -> Operation:
    kinds = one.get("requestBody", {}).get("content", {})
    body = tuple(short for kind, short in ((JSON, "json"), (FORM, "form")) if kind in kinds)
    tag = (one.get("tags") or ["service"])[0]
    return Operation(
        id=one["operationId"],
        method=method.upper(),
        path=path,
        name=method_name(one["operationId"], tag),
        summary=one.get("description") or one.get("summary", ""),
        parameters=tuple(_parameters(one, description["components"]["schemas"])),
        body=body,
        answers={
            status: {kind: found.get("schema", {}) for kind, found in a.get("content", {}).items()}
            for status, a in one["responses"].items()
            if status.startswith("2")
        },
        is_optional_body=bool(body) and not one["requestBody"].get("required", False),
    )


def _parameters(one: Schema, schemas: Mapping[str, Schema]) -> Iterator[Parameter]:
    for found in one.get("parameters", []):
        if found["in"] in {"path", "query"}:
            schema = {"description": found.get("description", ""), **found["schema"]}
            yield Parameter(found["name"], schema, found.get("required", False), found["in"])
    yield from _filters(one, schemas)
    yield from _body_parameters(one.get("requestBody", {}).get("content", {}), schemas)


def _filters(one: Schema, schemas: Mapping[str, Schema]) -> Iterator[Parameter]:
    """A parameter for the filters whose names no description can list, as `meta.KEY`."""
    known = {found["name"] for found in one.get("parameters", []) if found["in"] == "query"}
    for name, schema in schemas.items():
        if "patternProperties" in schema and schema["properties"].keys() <= known:
            reference = {"$ref": f"{PREFIX}{name}", "description": FILTERS}
            yield Parameter("filter", reference, is_required=False, place="filter")


def _body_parameters(
    content: Mapping[str, Any], schemas: Mapping[str, Schema]
) -> Iterator[Parameter]:
    json = _object(content.get(JSON, {}).get("schema", {}), schemas)
    form = _object(content.get(FORM, {}).get("schema", {}), schemas)
    fields, form_fields = json.get("properties", {}), form.get("properties", {})
    needed = (
        set(json.get("required", ())) & set(form.get("required", ()))
        if form and json
        else (set(json.get("required", ())) | set(form.get("required", ())))
    )
    for name, schema in {**form_fields, **fields}.items():
        is_file = form_fields.get(name, {}).get("format") == "binary"
        in_both = name in fields and name in form_fields
        place = "file" if is_file else "both" if in_both else "json" if name in fields else "form"
        yield Parameter(name, schema, name in needed, place)


def _object(schema: Schema, schemas: Mapping[str, Schema]) -> Schema:
    """The object that a body is; null is left out."""
    if "$ref" in schema:
        return schemas[name_of(schema["$ref"])]
    for one in schema.get("anyOf", ()):
        if one.get("type") != "null":
            return _object(one, schemas)
    return schema
