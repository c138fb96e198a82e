"""The names of joints in files: any encoding; printable and short."""

from __future__ import annotations

from app.formats.common.failures import unreadable_line
from app.formats.common.numbers import excerpt

MAX_NAME_LENGTH = 200
"""The most characters of a joint's name."""


def readable_name(name: bytes, line: int) -> str:
    """The name of a joint as text, from its bytes on line `line`.

    Bytes that are not UTF-8 are read as Latin-1. Raises Unreadable if the name is empty, too long
    or not printable.
    """
    try:
        text = name.decode("utf-8")
    except UnicodeDecodeError:
        text = name.decode("latin-1")
    if not text or len(text) > MAX_NAME_LENGTH or not text.isprintable():
        raise unreadable_line(line, f"expected a joint's name, found {excerpt(name)}")
    return text
