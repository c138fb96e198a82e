"""Encodes the position in a list as an opaque cursor, and decodes cursors that clients send.

A cursor is a JSON array of texts and numbers in URL-safe base64 without padding. `decode` and the
`as_...` functions raise only NotACursor, for any input.
"""

from __future__ import annotations

import base64
import json
import math
from collections.abc import Sequence

MAX_CURSOR_LENGTH = 4096
"""Characters."""


class NotACursor(ValueError):
    """The text is no cursor, or a value in it has the wrong type."""


def encode(values: Sequence[str | float | list[float] | None]) -> str:
    """A cursor that holds `values`."""
    # Without escapes: a long name in a script other than Latin would exceed MAX_CURSOR_LENGTH.
    content = json.dumps(values, separators=(",", ":"), ensure_ascii=False)
    return base64.urlsafe_b64encode(content.encode()).decode().rstrip("=")


def decode(cursor: str) -> list[object]:
    """The values in a cursor; each can be any JSON value. Raises NotACursor."""
    if len(cursor) > MAX_CURSOR_LENGTH:
        raise NotACursor("the cursor is too long")
    padded = cursor + "=" * (-len(cursor) % 4)
    try:
        content = base64.b64decode(padded.encode("ascii"), altchars=b"-_", validate=True)
        values = json.loads(content)
    except (ValueError, RecursionError) as problem:
        raise NotACursor("the cursor is not JSON in base64") from problem
    if not isinstance(values, list):
        raise NotACursor("the cursor holds no array")
    return values


def as_text(value: object) -> str:
    """A text that a database can store. Raises NotACursor for any other value."""
    if not isinstance(value, str):
        raise NotACursor("not a text")
    try:
        value.encode()
    except UnicodeEncodeError as problem:  # JSON allows half of a surrogate pair
        raise NotACursor("not a text that can be stored") from problem
    return value


def as_number(value: object) -> float:
    """A finite number. Raises NotACursor for any other value."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise NotACursor("not a number")
    try:
        number = float(value)
    except OverflowError as problem:
        raise NotACursor("too large a number") from problem
    if not math.isfinite(number):
        raise NotACursor("not a finite number")
    return number


def as_count(value: object, maximum: int) -> int:
    """A whole number from 0 to `maximum`. Raises NotACursor for any other value."""
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value <= maximum:
        raise NotACursor("not a whole number in range")
    return value
