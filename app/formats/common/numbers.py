"""Numbers as motion files write them: white space, commas, exponents, decimal commas."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.formats.common.failures import unreadable_line
from app.numerics.arrays import FloatArray

MAX_MAGNITUDE = 1e9
"""No coordinate or angle of a body is larger; sums along a chain stay within float32."""


def parse_numbers(text: bytes, line: int, expected: int | None = None) -> FloatArray:
    """The numbers (n,) float64 within MAX_MAGNITUDE that stand in `text`, line `line`.

    A comma separates numbers unless, read as a decimal point, it gives just the
    `expected` number of them. Raises Unreadable naming the line.
    """
    numbers = parse_any_numbers(text, line, expected)
    check_magnitudes(numbers[None], [line])
    return numbers


def parse_any_numbers(text: bytes, line: int, expected: int | None = None) -> FloatArray:
    """As `parse_numbers`, but NaN and what is too large passes; `check_magnitudes` finds
    them in many lines at once, which is cheaper."""
    if b"," in text:
        text = _without_commas(text, expected)
    if b"_" in text:  # numpy reads 1_0 as 10
        raise unreadable_line(line, f"expected numbers, found {excerpt(text)}")
    tokens = text.split()
    try:
        return np.array(tokens, dtype=np.float64)
    except ValueError:
        bad = next(token for token in tokens if not _is_number(token))
        raise unreadable_line(line, f"expected a number, found {excerpt(bad)}") from None


def check_magnitudes(rows: FloatArray, lines: Sequence[int]) -> None:
    """Raise Unreadable naming the first of `lines` (n,) whose row of `rows` (n, numbers)
    holds NaN or a number beyond MAX_MAGNITUDE."""
    if not rows.size or max(rows.max(), -rows.min()) <= MAX_MAGNITUDE:  # False for NaN
        return
    row, column = np.argwhere(~(np.abs(rows) <= MAX_MAGNITUDE))[0]
    limit = f"±{MAX_MAGNITUDE:g}"
    raise unreadable_line(lines[row], f"expected numbers within {limit}, found {rows[row, column]}")


def _is_number(token: bytes) -> bool:
    try:
        float(token)
    except ValueError:
        return False
    return True


def _without_commas(text: bytes, expected: int | None) -> bytes:
    separated = text.replace(b",", b" ")
    if expected is not None and len(separated.split()) != expected == len(text.split()):
        return text.replace(b",", b".")
    return separated


def excerpt(text: bytes, length: int = 40) -> str:
    """`text` quoted for a message: printable and short."""
    shown = text[:length].decode("utf-8", errors="replace").strip()
    shown = "".join(char if char.isprintable() else "�" for char in shown)
    return f"'{shown}…'" if len(text) > length else f"'{shown}'"
