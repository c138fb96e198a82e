"""Reads tables of plain decimal numbers, many lines at once.

Most motion files contain only numbers such as `-12.3456` or `5.1e-06`. To read them as whole
numbers divided by powers of ten is several times faster than to read them one by one. Numbers in
other forms are left to the slower reader in `numbers.py`, which also reports what is wrong and
where.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from app.numerics.arrays import BoolArray, FloatArray, IntArray

PLAIN = b"0123456789.- \t\neE+"
"""The only characters of plain numbers and of the blanks between them."""
MAX_DIGITS = 15
"""A whole number with at most this many digits is exact in float64."""
MAX_POWER = 22
"""So is a power of ten up to this one. One division of both gives the same rounding as reading the
decimal number."""

_POWERS = 10.0 ** np.arange(MAX_POWER + 1)
_MINUS, _PLUS, _DOT, _NEWLINE, _BLANK = (mark[0] for mark in (b"-", b"+", b".", b"\n", b" "))
_EXPONENT, _LOWER_CASE = b"e"[0], 0x20

Characters = NDArray[np.uint8]


def plain_table(lines: Sequence[bytes], columns: int) -> FloatArray | None:
    """(lines, columns) float64, with the values that `float` gives for each number.

    None if a line does not have `columns` numbers, or if a number is not plain. A plain number has
    at most MAX_DIGITS digits, one point, one leading minus, and an exponent of a sign and two
    digits, which with the digits after the point gives at most MAX_POWER.
    """
    text = b"\n".join(lines) + b"\n"
    if text.translate(None, PLAIN):
        return None
    characters = np.frombuffer(text, dtype=np.uint8)
    if not any(mark in text for mark in (b"e", b"E", b"+")):
        return _table(text, characters, len(lines), columns, None)
    exponents = _exponents(characters)
    if exponents is None:
        return None
    at, powers = exponents
    mantissas = characters.copy()
    mantissas[at[:, None] + np.arange(4)] = _BLANK
    return _table(mantissas.tobytes(), mantissas, len(lines), columns, (at, powers))


def _table(
    text: bytes,
    characters: Characters,
    lines: int,
    columns: int,
    exponents: tuple[IntArray, IntArray] | None,
) -> FloatArray | None:
    """`plain_table` of the numbers in `text`, also as `characters`, without their exponents.

    exponents: (e,) the places of the blanks that replace the exponents, and (e,) their values.
    """
    starts, ends = _words(characters <= _BLANK)
    if len(starts) != lines * columns or not _have_columns(starts, characters, columns):
        return None
    is_negative = characters[starts] == _MINUS
    if text.count(b"-") != np.count_nonzero(is_negative) or b"+" in text:
        return None
    points = _points(characters, starts, ends)
    if points is None:
        return None
    words, decimals = points
    digits = ends - starts - is_negative
    digits[words] -= 1
    powers = np.zeros(len(ends), dtype=np.int64)
    powers[words] = decimals
    if exponents is not None:
        powers[np.searchsorted(ends, exponents[0])] -= exponents[1]
    if not (_within(digits, 1, MAX_DIGITS) and _within(powers, 0, MAX_POWER)):
        return None
    numbers = np.fromstring(text.translate(None, b"."), dtype=np.int64, sep=" ")
    values = numbers / _POWERS[powers]
    # The whole number 0 has no sign, so the minus of -0.0 is added here.
    np.negative(values, out=values, where=is_negative & (numbers == 0))
    return np.asarray(values.reshape(lines, columns))


def _exponents(characters: Characters) -> tuple[IntArray, IntArray] | None:
    """(e,) the place of each E, and (e,) the number after it; None if one is not plain."""
    at = np.flatnonzero(characters | _LOWER_CASE == _EXPONENT)
    if len(at) and at[-1] + 4 >= len(characters):
        return None
    sign, tens, ones, after = characters[at[:, None] + np.arange(1, 5)].T
    is_negative = sign == _MINUS
    are_digits = _are_digits(tens) & _are_digits(ones)
    if not np.all((is_negative | (sign == _PLUS)) & are_digits & (after <= _BLANK)):
        return None
    sizes = 10 * (tens.astype(np.int64) - b"0"[0]) + (ones - b"0"[0])
    return at, np.where(is_negative, -sizes, sizes)


def _are_digits(characters: Characters) -> BoolArray:
    return np.asarray((characters >= b"0"[0]) & (characters <= b"9"[0]))


def _words(is_blank: BoolArray) -> tuple[IntArray, IntArray]:
    """(words,) the first index of each word, and of the blank after it.

    is_blank: (characters,). The last character must be blank.
    """
    edges = np.flatnonzero(is_blank[1:] != is_blank[:-1]) + 1
    if len(is_blank) and not is_blank[0]:
        edges = np.concatenate([[0], edges])
    return edges[::2], edges[1::2]


def _have_columns(starts: IntArray, characters: Characters, columns: int) -> bool:
    """Whether each line has `columns` words; starts: (words,) the first index of each word."""
    newlines = np.flatnonzero(characters == _NEWLINE)
    expected = columns * np.arange(1, len(newlines) + 1)
    return bool(np.array_equal(np.searchsorted(starts, newlines), expected))


def _points(
    characters: Characters, starts: IntArray, ends: IntArray
) -> tuple[IntArray | slice, IntArray] | None:
    """The words that have a point, and the number of digits after each point.

    starts, ends: (words,) of `_words`. None if a word has two points.
    """
    points = np.flatnonzero(characters == _DOT)
    if len(points) == len(ends) and np.all((starts <= points) & (points < ends)):
        return slice(None), ends - points - 1
    words = np.searchsorted(ends, points)
    if np.any(words[1:] == words[:-1]):
        return None
    return words, ends[words] - points - 1


def _within(values: IntArray, low: int, high: int) -> bool:
    return bool(len(values) == 0 or (values.min() >= low and values.max() <= high))
