"""Numbers as motion files write them: white space, commas, exponents, decimal commas."""

from __future__ import annotations

import numpy as np

from app.errors import Unreadable
from app.formats.places import unreadable
from app.numerics.arrays import FloatArray

MAX_MAGNITUDE = 1e9
"""No coordinate or angle of a body is larger; sums along a chain stay within float32."""


def parse_numbers(text: bytes, line: int, expected: int | None = None) -> FloatArray:
    """The finite numbers (n,) float64 that stand in `text`, which is line `line`.

    A comma separates numbers unless, read as a decimal point, it gives just the
    `expected` number of them. Raises Unreadable naming the line.
    """
    if b"," in text:
        text = _without_commas(text, expected)
    if b"_" in text:  # numpy reads 1_0 as 10
        raise unreadable(line, f"expected numbers, found {excerpt(text)}")
    return _checked(text.split(), line)


def _without_commas(text: bytes, expected: int | None) -> bytes:
    separated = text.replace(b",", b" ")
    if expected is not None and len(separated.split()) != expected == len(text.split()):
        return text.replace(b",", b".")
    return separated


def _checked(tokens: list[bytes], line: int) -> FloatArray:
    try:
        numbers = np.array(tokens, dtype=np.float64)
    except ValueError:
        raise _first_bad(tokens, line) from None
    if numbers.size and not max(numbers.max(), -numbers.min()) <= MAX_MAGNITUDE:
        raise _first_bad(tokens, line)
    return numbers


def _first_bad(tokens: list[bytes], line: int) -> Unreadable:
    for token in tokens:
        try:
            good = abs(float(token)) <= MAX_MAGNITUDE
        except ValueError:
            good = False
        if not good:
            return unreadable(
                line, f"expected a number within ±{MAX_MAGNITUDE:g}, found {excerpt(token)}"
            )
    return unreadable(line, "expected numbers")


def excerpt(text: bytes, length: int = 40) -> str:
    """`text` quoted for a message: printable and short."""
    shown = text[:length].decode("utf-8", errors="replace").strip()
    shown = "".join(char if char.isprintable() else "�" for char in shown)
    return f"'{shown}…'" if len(text) > length else f"'{shown}'"
