"""JSON schemas as Python types."""

from __future__ import annotations

import keyword
import re
from collections.abc import Iterator, Mapping
from typing import Any

Schema = Mapping[str, Any]
_SHAPE = re.compile(r"\([\w ]+,[\w ,]*\)")
"""Descriptions of arrays name their shape, as in "(frames, joints, 3), meters"."""
_PLAIN = {"string": "str", "integer": "int", "number": "float", "boolean": "bool", "null": "None"}
PREFIX = "#/components/schemas/"


class Types:
    """Writes types for values that are sent or received.

    schemas: the components of the description, by name. sent: whether the values are sent;
    then any sequence and mapping is accepted.
    """

    def __init__(self, schemas: Mapping[str, Schema], *, sent: bool) -> None:
        self.schemas = schemas
        self.sent = sent

    def of(self, schema: Schema) -> str:
        """The type of a value."""
        if "$ref" in schema:
            return self._component(name_of(schema["$ref"]))
        if "const" in schema:
            return f"Literal[{schema['const']!r}]".replace("'", '"')
        if "enum" in schema:
            return literal(schema)
        for union in ("anyOf", "oneOf"):
            if union in schema:
                return self._union(schema[union])
        if len(schema.get("allOf", ())) == 1:
            return self.of(schema["allOf"][0])
        return self._of_kind(schema)

    def _component(self, name: str) -> str:
        # a TypedDict has no members whose names are not known
        is_open = self.sent and "patternProperties" in self.schemas.get(name, {})
        return f"{name} | Mapping[str, Any]" if is_open else name

    def _union(self, members: list[Schema]) -> str:
        kinds = dict.fromkeys(self.of(member) for member in members)
        if "Any" in kinds:
            return "Any"
        return " | ".join(sorted(kinds, key=lambda kind: kind == "None"))

    def _of_kind(self, schema: Schema) -> str:
        kind = schema.get("type")
        if schema.get("contentMediaType") == "application/json":
            return self.of(schema.get("contentSchema", {"type": "object"}))
        if kind == "array":
            return self._array(schema)
        if kind == "object":
            return self._mapping(schema)
        if schema.get("format") == "date-time" and not self.sent:
            return "datetime"
        return _PLAIN.get(kind, "Any") if isinstance(kind, str) else "Any"

    def _array(self, schema: Schema) -> str:
        if not self.sent and is_array(schema):
            return "Array"
        name = "Sequence" if self.sent else "list"
        return f"{name}[{self.of(schema.get('items', {}))}]"

    def _mapping(self, schema: Schema) -> str:
        values = schema.get("additionalProperties", True)
        inner = self.of(values) if isinstance(values, Mapping) else "Any"
        return f"{'Mapping' if self.sent else 'dict'}[str, {inner}]"


def identifier(name: str) -> str:
    """A name as Python spells it: keywords end with an underscore."""
    return f"{name}_" if keyword.iskeyword(name) else name


def literal(schema: Schema) -> str:
    """The type of a value that is one of some texts."""
    return "Literal[" + ", ".join(f'"{one}"' for one in schema["enum"]) + "]"


def is_array(schema: Schema) -> bool:
    """Whether a list of numbers is an array: nested, or with a shape in its description."""
    items = schema.get("items", {})
    if items.get("type") == "array":
        return _innermost(items) in {"number", "integer"}
    numeric = items.get("type") in {"number", "integer"}
    return numeric and bool(_SHAPE.search(schema.get("description", "")))


def _innermost(schema: Schema) -> Any:
    return _innermost(schema["items"]) if schema.get("type") == "array" else schema.get("type")


def name_of(reference: str) -> str:
    """The name of a component that a reference points to."""
    return reference.removeprefix(PREFIX)


def references(schema: Any) -> Iterator[str]:
    """The names of all components that a part of the description refers to directly."""
    if isinstance(schema, Mapping):
        if isinstance(schema.get("$ref"), str):
            yield name_of(schema["$ref"])
        for value in schema.values():
            yield from references(value)
    elif isinstance(schema, list):
        for value in schema:
            yield from references(value)


def closure(names: set[str], schemas: Mapping[str, Schema]) -> set[str]:
    """The components with these names, and all to which they refer."""
    found: set[str] = set()
    left = set(names)
    while left:
        name = left.pop()
        found.add(name)
        left |= set(references(schemas[name])) - found
    return found
