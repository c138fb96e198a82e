"""Reads tables of plain decimal numbers, many lines at once.

Most motion files contain only numbers such as `-12.3456`. To read them as whole numbers divided by
powers of ten is several times faster than to read them one by one. Numbers in other forms are left
to the slower reader in `numbers.py`, which also reports what is wrong and where.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.numerics.arrays import BoolArray, FloatArray, IntArray

PLAIN = b"0123456789.- \t\n"
"""The only characters of plain numbers and of the blanks between them."""
MAX_DIGITS = 15
"""A whole number with at most this many digits is exact in float64. So one division gives the same
rounding as reading the decimal number."""

_POWERS = 10.0 ** np.arange(MAX_DIGITS + 1)
_MINUS, _DOT, _NEWLINE, _BLANK = b"-"[0], b"."[0], b"\n"[0], b" "[0]


def plain_table(lines: Sequence[bytes], columns: int) -> FloatArray | None:
    """(lines, columns) float64, with the values that `float` gives for each number.

    None if a line does not have `columns` numbers, or if a number is not plain. A plain number has
    digits, at most one point and one leading minus, and at most MAX_DIGITS characters.
    """
    text = b"\n".join(lines) + b"\n"
    if text.translate(None, PLAIN):
        return None
    characters = np.frombuffer(text, dtype=np.uint8)
    starts, ends = _words(characters <= _BLANK)
    if len(starts) != len(lines) * columns or not _have_columns(starts, characters, columns):
        return None
    decimals = _decimals(characters, ends)
    if decimals is None or np.max(ends - starts, initial=0) > MAX_DIGITS:
        return None
    is_negative = characters[starts] == _MINUS
    numbers = _whole_numbers(text, int(is_negative.sum()))
    if numbers is None or len(numbers) != len(starts):
        return None
    values = numbers / _POWERS[decimals]
    # The whole number 0 has no sign, so the minus of -0.0 is added here.
    np.negative(values, out=values, where=is_negative & (numbers == 0))
    return np.asarray(values.reshape(len(lines), columns))


def _words(is_blank: BoolArray) -> tuple[IntArray, IntArray]:
    """(words,) the first index of each word, and of the blank after it.

    is_blank: (characters,). The last character must be blank.
    """
    before = np.concatenate([[True], is_blank[:-1]])
    return np.flatnonzero(before & ~is_blank), np.flatnonzero(is_blank & ~before)


def _have_columns(starts: IntArray, characters: np.ndarray, columns: int) -> bool:
    """Whether each line has `columns` words; starts: (words,) the first index of each word."""
    newlines = np.flatnonzero(characters == _NEWLINE)
    expected = columns * np.arange(1, len(newlines) + 1)
    return bool(np.array_equal(np.searchsorted(starts, newlines), expected))


def _decimals(characters: np.ndarray, ends: IntArray) -> IntArray | None:
    """(words,) the number of digits after the point, 0 without a point.

    ends: (words,) the index of the blank after each word. None if a word has two points.
    """
    points = np.flatnonzero(characters == _DOT)
    words = np.searchsorted(ends, points)
    if np.any(np.diff(words) == 0):
        return None
    decimals = np.zeros(len(ends), dtype=np.int64)
    decimals[words] = ends[words] - points - 1
    return decimals


def _whole_numbers(text: bytes, negative: int) -> IntArray | None:
    """(words,) the words as whole numbers, read without their points.

    negative: the number of words that begin with a minus. None if a minus is inside a word, or has
    no digits after it. A word that is only a point gives no number.
    """
    whole = text.replace(b".", b"")
    if text.count(b"-") != negative or any(alone in whole for alone in (b"- ", b"-\t", b"-\n")):
        return None
    return np.fromstring(whole, dtype=np.int64, sep=" ")
