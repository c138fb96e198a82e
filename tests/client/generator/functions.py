"""Writes the function of an operation: it builds the call."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Mapping

from tests.client.generator.operations import EVENTS, JSON, OCTETS, Operation, Parameter
from tests.client.generator.schemas import Schema, Types, name_of

WIDTH = 93
_LISTED = {
    "limit": "Maximum number of items in all; None lists all.",
    "cursor": "Where the list starts: `next` of an earlier page.",
}
PROGRESS = "Called with the bytes that were sent and the bytes in total."


class Functions:
    """Writes functions. schemas: the components of the description, by name."""

    def __init__(self, schemas: Mapping[str, Schema]) -> None:
        self._schemas = schemas
        self._sent = Types(schemas, sent=True)

    def of(self, one: Operation) -> list[str]:
        """The functions of an operation: none for events, two if its answer has two forms."""
        kinds = one.answer_types()
        if kinds == {EVENTS}:
            return []
        functions = [self._function(one, one.id, *self._answer(one))]
        if {JSON, OCTETS} <= kinds:
            functions.append(
                self._function(one, f"{one.id}_array", "Positions", "positions", "OCTETS")
            )
        return functions

    def item_of(self, one: Operation) -> str | None:
        """The type of the items of a list with a cursor; None for other operations."""
        model = self._schemas.get(one.answer_model() or "", {})
        items = model.get("properties", {}).get("items", {}).get("items", {})
        is_paged = any(p.name == "cursor" and p.place == "query" for p in one.parameters)
        return name_of(items["$ref"]) if is_paged and "$ref" in items else None

    def _answer(self, one: Operation) -> tuple[str, str, str]:
        """The type of the answer, the function that reads it, and the media type to accept."""
        model, kinds = one.answer_model(), one.answer_types()
        if model is not None and not all(one.answers.values()):
            # some statuses have no content
            return f"{model} | None", f"record_if_any({model})", "JSON"
        if model is not None:
            return model, f"record({model})", "JSON"
        if JSON in kinds:
            return "Any", "value", "JSON"
        if not kinds:
            return "None", "nothing", "JSON"
        if all(kind.startswith(("text/plain", "image/svg")) for kind in kinds):
            return "str", "text", '"*/*"'
        return "bytes", "read_bytes", '"*/*"'

    def _function(self, one: Operation, name: str, answer: str, read: str, accept: str) -> str:
        arguments = [f'"{one.id}"', f'"{one.method}"', self._path(one), read]
        arguments += self._contents(one)
        if accept != "JSON":
            arguments.append(f"accept={accept}")
        head = f"def {name}({', '.join(self._signature(one))}) -> Call[{answer}]:"
        doc = textwrap.indent(self._docstring(one, is_array=name != one.id), "    ")
        return f"{head}\n{doc}\n    return Call({', '.join(arguments)})\n"

    def _path(self, one: Operation) -> str:
        parts = [p.name for p in one.parameters if p.place == "path"]
        if not parts:
            return f'"{one.path}"'
        return f'path_of("{one.path}", {", ".join(f"{name}={name}" for name in parts)})'

    def _contents(self, one: Operation) -> list[str]:
        """The arguments of `Call` for the query, the body and the files."""
        found = []
        if query := [p for p in one.parameters if p.place == "query"]:
            has_filter = any(p.place == "filter" for p in one.parameters)
            more = " | given(**(filter or {}))" if has_filter else ""
            found.append(f"query={_given(query)}{more}")
        fields = [p for p in one.parameters if p.place in {"json", "form", "both"}]
        collect = "corrections" if one.method == "PATCH" else "given"
        if "json" in one.body:
            body = _given(fields, collect)
            found.append(f"json={body} or UNSET" if one.is_optional_body else f"json={body}")
        if "form" in one.body:
            found.append(f"fields={_given(fields)}")
            found.append(f"files={_given([p for p in one.parameters if p.place == 'file'])}")
            found.append("progress=progress")
        return found

    def _signature(self, one: Operation) -> list[str]:
        first = [p for p in one.parameters if p.is_required]
        first.sort(key=lambda p: p.place != "path")
        rest = [p for p in one.parameters if not p.is_required]
        if not first or "file" in {p.place for p in rest}:
            first += [p for p in rest if p.name == "clip_id"]
        words = [self._argument(one, p) for p in first]
        rest = [p for p in rest if p not in first]
        keywords = [self._argument(one, p) for p in rest]
        if "form" in one.body:
            keywords.append("progress: Progress | None = None")
        return [*words, *(["*", *keywords] if keywords else [])]

    def _argument(self, one: Operation, parameter: Parameter) -> str:
        kind = "FileInput" if parameter.place == "file" else self._sent.of(parameter.schema)
        if parameter.place in {"form", "both"}:
            kind = _of_text(parameter.description) or kind
        if parameter.is_required:
            return f"{parameter.name}: {kind}"
        if one.method == "PATCH":
            known = kind.removesuffix(" | None")
            return f"{parameter.name}: {known} | Unset | None = UNSET"
        return f"{parameter.name}: {kind if kind.endswith('None') else f'{kind} | None'} = None"

    def _docstring(self, one: Operation, *, is_array: bool) -> str:
        summary, _, rest = one.summary.strip().partition("\n\n")
        lines = _wrapped(f"{_one_line(summary)} The answer is an array." if is_array else summary)
        paragraphs = [lines, *(_paragraph(one) for one in rest.split("\n\n") if one.strip())]
        described = [text for p in one.parameters if (text := self._described(one, p))]
        described += [f"progress: {PROGRESS}"] if "form" in one.body else []
        if described:
            paragraphs.append("\n".join(_wrapped(text) for text in described))
        body = "\n\n".join(paragraphs).replace("\\", "\\\\").replace('"""', "'''")
        return f'"""{body}\n"""' if "\n" in body else f'"""{body}"""'

    def _described(self, one: Operation, parameter: Parameter) -> str:
        text = _one_line(parameter.description) + _default(parameter.schema)
        if self.item_of(one) is not None:
            text = _LISTED.get(parameter.name, text)
        return f"{parameter.name}: {text.strip()}" if text.strip() else ""


def _of_text(description: str) -> str | None:
    """The type of a field of a form whose text is a list or JSON; None for another field."""
    if description.startswith("Separated by spaces"):
        return "str | Sequence[str] | None"
    return "str | Mapping[str, Any] | None" if description.startswith("JSON:") else None


def _default(schema: Schema) -> str:
    default = schema.get("default")
    return "" if default is None else f" Default: {default}."


def _paragraph(text: str) -> str:
    """A paragraph with lines that fit; each point of a list begins a line."""
    points = re.split(r"\n(?=- )", text.strip())
    return "\n".join(_wrapped(point) for point in points)


def _given(parameters: list[Parameter], collect: str = "given") -> str:
    return f"{collect}({', '.join(f'{p.name}={p.name}' for p in parameters)})"


def _one_line(text: str) -> str:
    return re.sub(r"\s+", " ", text).strip()


def _wrapped(text: str) -> str:
    return textwrap.fill(
        _one_line(text),
        WIDTH,
        subsequent_indent="    " if ": " in text.split(" ")[0] + " " else "",
        break_long_words=False,
        break_on_hyphens=False,
    )
