"""Reads the numbers of motion files, with white space, commas, exponents or decimal commas."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.formats.common.failures import unreadable_line
from app.numerics.arrays import FloatArray

MAX_MAGNITUDE = 1e9
"""The largest coordinate or angle of a body. Sums along a chain of joints then fit in float32."""


def parse_numbers(text: bytes, line: int, expected: int | None = None) -> FloatArray:
    """(n,) float64 the numbers in `text`, which is on line `line` of the file.

    A comma separates numbers. Only if commas as decimal points give exactly `expected` numbers, and
    commas as separators do not, they are decimal points. Raises Unreadable with the line, also for
    numbers beyond MAX_MAGNITUDE.
    """
    numbers = parse_any_numbers(text, line, expected)
    check_magnitudes(numbers[None], [line])
    return numbers


def parse_any_numbers(text: bytes, line: int, expected: int | None = None) -> FloatArray:
    """As `parse_numbers`, but NaN and numbers that are too large are accepted.

    `check_magnitudes` finds these in many lines at once, which is faster.
    """
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
    """Raise Unreadable for the first row with NaN or a number beyond MAX_MAGNITUDE.

    rows: (n, numbers). lines: (n,) the line of each row in the file.
    """
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
    """The start of `text` in quotes, for a message: printable and short."""
    shown = text[:length].decode("utf-8", errors="replace").strip()
    shown = "".join(char if char.isprintable() else "�" for char in shown)
    return f"'{shown}…'" if len(text) > length else f"'{shown}'"
