"""Tables of plain decimal numbers, many lines at once.

Most motion files hold nothing else (`-12.3456`), and reading them as whole numbers over
powers of ten is several times faster than number by number. What is not so plain is left
to the slower reader, which also knows what is wrong and where.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.numerics.arrays import BoolArray, FloatArray, IntArray

PLAIN = b"0123456789.- \t\n"
MAX_DIGITS = 15
"""A whole number of so many digits is exact as float64, so that one division rounds as
reading the decimal does."""

_POWERS = 10.0 ** np.arange(MAX_DIGITS + 1)
_MINUS, _DOT, _NEWLINE, _BLANK = b"-"[0], b"."[0], b"\n"[0], b" "[0]


def plain_table(lines: Sequence[bytes], columns: int) -> FloatArray | None:
    """(lines, columns) float64, as `float` reads each number.

    None where a line has another number of them, or where a number is not plain: digits with
    at most one point and one leading minus, MAX_DIGITS characters in all.
    """
    text = b"\n".join(lines) + b"\n"
    if text.translate(None, PLAIN):
        return None
    characters = np.frombuffer(text, dtype=np.uint8)
    starts, ends = _words(characters <= _BLANK)
    if len(starts) != len(lines) * columns or not _are_even(starts, characters, columns):
        return None
    decimals = _decimals(characters, ends)
    if decimals is None or np.max(ends - starts, initial=0) > MAX_DIGITS:
        return None
    is_negative = characters[starts] == _MINUS
    numbers = _whole_numbers(text, int(is_negative.sum()))
    if numbers is None or len(numbers) != len(starts):
        return None
    values = numbers / _POWERS[decimals]
    np.negative(values, out=values, where=is_negative & (numbers == 0))  # -0.0
    return np.asarray(values.reshape(len(lines), columns))


def _words(is_blank: BoolArray) -> tuple[IntArray, IntArray]:
    """Where words start, and where the blanks after them do; the last character is blank."""
    before = np.concatenate([[True], is_blank[:-1]])
    return np.flatnonzero(before & ~is_blank), np.flatnonzero(is_blank & ~before)


def _are_even(starts: IntArray, characters: np.ndarray, columns: int) -> bool:
    """Whether each line has `columns` words."""
    newlines = np.flatnonzero(characters == _NEWLINE)
    expected = columns * np.arange(1, len(newlines) + 1)
    return bool(np.array_equal(np.searchsorted(starts, newlines), expected))


def _decimals(characters: np.ndarray, ends: IntArray) -> IntArray | None:
    """Digits after each word's point, 0 without one; None where a word has two."""
    points = np.flatnonzero(characters == _DOT)
    words = np.searchsorted(ends, points)
    if np.any(np.diff(words) == 0):
        return None
    decimals = np.zeros(len(ends), dtype=np.int64)
    decimals[words] = ends[words] - points - 1
    return decimals


def _whole_numbers(text: bytes, negative: int) -> IntArray | None:
    """The words without their points, of which `negative` begin with a minus.

    None where a minus stands elsewhere or alone; words that are a point alone are left out.
    """
    whole = text.replace(b".", b"")
    if text.count(b"-") != negative or any(alone in whole for alone in (b"- ", b"-\t", b"-\n")):
        return None
    return np.fromstring(whole, dtype=np.int64, sep=" ")
