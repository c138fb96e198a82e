"""The names of joints in files: any encoding; printable and short."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import takewhile

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


def without_common_prefix(labels: Sequence[str]) -> list[str]:
    """The labels without the name with which all of them begin: `Ada_LKNE`, `Ada_RKNE`, ..."""
    if not labels:
        return []
    # What the first and the last label in the alphabet share, all labels share.
    pairs = zip(min(labels), max(labels), strict=False)
    prefix = "".join(one for one, _ in takewhile(lambda pair: pair[0] == pair[1], pairs))
    cut = max(prefix.rfind(mark) for mark in "_: ") + 1
    return [label[cut:] for label in labels]
