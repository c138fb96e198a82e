"""Writes the types of answers (dataclasses), of bodies (TypedDict), and of choices (Literal)."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Mapping

from tests.client.generator.schemas import Schema, Types, identifier, literal, references

WIDTH = 96


class Models:
    """Writes classes. schemas: the components of the description, by name."""

    def __init__(self, schemas: Mapping[str, Schema]) -> None:
        self._schemas = schemas
        self._received = Types(schemas, sent=False)
        self._sent = Types(schemas, sent=True)

    def choice(self, name: str) -> str:
        """An alias of the texts that a value may be."""
        return f"{name}: TypeAlias = {literal(self._schemas[name])}\n"

    def record(self, name: str) -> str:
        """The dataclass of a component of answers."""
        schema = self._schemas[name]
        fields = {
            identifier(field): self._field(one, field in schema.get("required", ()))
            for field, one in schema.get("properties", {}).items()
        }
        item = re.fullmatch(r"list\[(\w+)\]", fields.get("items", ""))
        base = f"Page[{item[1]}]" if item and "next" in fields else "Record"
        eq = ", eq=False" if any("Array" in kind for kind in fields.values()) else ""
        body = "\n".join(f"    {field}: {kind}" for field, kind in fields.items())
        head = f"@dataclass(frozen=True, slots=True{eq})\nclass {name}({base}):"
        return f"{head}\n{self._doc(schema, name)}\n\n{body}\n"

    def sent(self, name: str) -> str:
        """The TypedDict of a component of bodies."""
        schema = self._schemas[name]
        needed = schema.get("required", ())
        fields = []
        for field, one in schema.get("properties", {}).items():
            kind = self._sent.of(one)
            fields.append(f"    {field}: {kind if field in needed else f'NotRequired[{kind}]'}\n")
        return f"class {name}(TypedDict):\n{self._doc(schema, name)}\n\n{''.join(fields)}"

    def in_order(self, names: set[str]) -> list[str]:
        """The names such that each comes after those to which it refers."""
        ordered: list[str] = []

        def visit(name: str, above: tuple[str, ...] = ()) -> None:
            for other in sorted(set(references(self._schemas[name])) & names - {name, *above}):
                visit(other, (*above, name))
            if name not in ordered:
                ordered.append(name)

        for name in sorted(names):
            visit(name)
        return ordered

    def _field(self, schema: Schema, is_required: bool) -> str:
        kind = self._received.of(schema)
        is_sure = is_required or "const" in schema or kind.endswith("None") or "default" in schema
        return kind if is_sure else f"{kind} | None"

    def _doc(self, schema: Schema, name: str) -> str:
        summary = schema.get("description") or f"{name}."
        fields = [
            textwrap.fill(f"{field}: {' '.join(one['description'].split())}", WIDTH - 4)
            for field, one in schema.get("properties", {}).items()
            if one.get("description")
        ]
        text = "\n\n".join([summary.strip(), *(["\n".join(fields)] if fields else [])])
        text = text.replace("\\", "\\\\")
        return textwrap.indent(f'"""{text}\n"""' if "\n" in text else f'"""{text}"""', "    ")
