"""Names of joints as files hold them: in any encoding, printable and short."""

from __future__ import annotations

from app.formats.common.failures import unreadable_line
from app.formats.common.numbers import excerpt

MAX_NAME_LENGTH = 200


def readable_name(name: bytes, line: int) -> str:
    """A joint's name that stands on line `line`. Raises Unreadable where it is none."""
    try:
        text = name.decode("utf-8")
    except UnicodeDecodeError:
        text = name.decode("latin-1")
    if not text or len(text) > MAX_NAME_LENGTH or not text.isprintable():
        raise unreadable_line(line, f"expected a joint's name, found {excerpt(name)}")
    return text
