"""The values of the metadata of clips: strings, numbers and booleans.

A filter compares the text of a value. So `age=30` finds the number 30 and the string "30", from a
query parameter as well as from JSON.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from enum import StrEnum

MetadataValue = str | int | float | bool
Metadata = Mapping[str, MetadataValue]
"""Values by key."""

MAX_WHOLE = 2**53
"""Above this, a float cannot hold every whole number."""
_NUMBER = re.compile(r"-?(0|[1-9]\d*)(\.\d+)?([eE][-+]?\d+)?")
_BOOLEANS = {"true": True, "false": False}


class ValueKind(StrEnum):
    """The kinds of values."""

    STRING = "string"
    """A text."""
    NUMBER = "number"
    """A finite number."""
    BOOLEAN = "boolean"
    """True or false."""


def kind_of(value: MetadataValue) -> ValueKind:
    """The kind of a value."""
    if isinstance(value, bool):
        return ValueKind.BOOLEAN
    return ValueKind.STRING if isinstance(value, str) else ValueKind.NUMBER


def as_text(value: MetadataValue) -> str:
    """The text of a value: `true`, `30`, `1.5`, or the string itself."""
    if isinstance(value, bool):
        return str(value).lower()
    return value if isinstance(value, str) else repr(tidy_number(value))


def tidy_number(value: float) -> int | float:
    """A number; a whole one as an int, so that 30 and 30.0 have the same text."""
    is_whole = abs(value) <= MAX_WHOLE and value == int(value)
    return int(value) if is_whole else float(value)


def from_text(kind: str, text: str) -> MetadataValue:
    """The value of a kind with this text; the reverse of `as_text`."""
    if kind == ValueKind.STRING:
        return text
    return _BOOLEANS[text] if kind == ValueKind.BOOLEAN else tidy_number(float(text))


def from_cell(cell: str) -> MetadataValue:
    """The value that a cell of a table stands for; the reverse of `as_cell`.

    A cell like `1.5` is a number and `true` is a boolean, in upper or lower case. A number with
    leading zeros (`007`), or a whole one that is too long for a float, is a string, so that no
    digit is lost. A cell in double quotes is a JSON string.
    """
    if cell.lower() in _BOOLEANS:
        return _BOOLEANS[cell.lower()]
    return tidy_number(float(cell)) if _is_number(cell) else _unquoted(cell)


def as_cell(value: MetadataValue) -> str:
    """A cell of a table that `from_cell` reads as this value."""
    text = as_text(value)
    if not isinstance(value, str) or from_cell(text) == value:
        return text
    return json.dumps(value, ensure_ascii=False)


def _is_number(cell: str) -> bool:
    if not _NUMBER.fullmatch(cell):
        return False
    digits = cell.lstrip("-")
    if digits.isdigit():
        return len(digits) <= len(str(MAX_WHOLE)) and int(digits) <= MAX_WHOLE
    return math.isfinite(float(cell))


def _unquoted(cell: str) -> str:
    if len(cell) > 1 and cell[0] == cell[-1] == '"':
        try:
            value = json.loads(cell)
        except ValueError:
            return cell
        return value if isinstance(value, str) else cell
    return cell
