"""Reads tables of numbers in text, whose empty cells are points that were not seen.

Cells are separated by tabs, semicolons or commas. With the first two, a comma in a number is a
decimal point. numpy's `loadtxt` reads the numbers; a table of 10 MB takes about a second.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.formats.bvh.frames import MAX_FRAMES
from app.formats.common.failures import too_large, unreadable_line
from app.formats.common.lines import filled_lines
from app.formats.common.numbers import MAX_MAGNITUDE, excerpt
from app.formats.common.world_positions import MAX_JOINT_FRAMES
from app.numerics.arrays import FloatArray

MAX_COLUMNS = 30_000
"""The most columns of a table: 10,000 points with three coordinates."""
_MISSING = re.compile(rb"(?<=,)\s*(?:n/?a|null|none|-|--|\.)?\s*(?=,)", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Row:
    """A line of text: its number, counted from 1, and its cells without spaces at their ends."""

    line: int
    cells: list[str]


def separator_of(line: bytes) -> bytes:
    """The separator of the cells of a line: a tab, else a semicolon, else a comma."""
    return next((mark for mark in (b"\t", b";") if mark in line), b",")


def cells_of(line: bytes, separator: bytes) -> list[str]:
    """The cells of a line of a header, without quotes and without spaces at their ends."""
    text = line.decode("utf-8", errors="replace")
    return [cell.strip().strip('"').strip() for cell in text.split(separator.decode())]


def read_numbers(text: bytes, first_line: int, columns: int, separator: bytes) -> FloatArray:
    """(rows, columns) float64 the numbers of a table, NaN in empty cells.

    text: the lines of the table, with plain newlines; blank lines are left out. first_line: the
    number of its first line. Cells beyond `columns` are not read, and cells that are missing at the
    end of a line are empty. Raises Unreadable with the line, and TooLarge.
    """
    rows = text.count(b"\n") + 1
    if rows > MAX_FRAMES:
        raise too_large("table", f"expected at most {MAX_FRAMES} lines of numbers")
    if columns > MAX_COLUMNS or rows * columns > 3 * MAX_JOINT_FRAMES:
        raise too_large("table", f"expected at most {3 * MAX_JOINT_FRAMES} numbers")
    numbered = list(filled_lines(text, first_line))
    lines = [_normalized(line, columns, separator) for _, line in numbered]
    table = _loaded(lines, numbered, columns) if lines else np.zeros((0, columns))
    large = np.abs(table) > MAX_MAGNITUDE
    if large.any():
        row, column = np.argwhere(large)[0]
        limit = f"±{MAX_MAGNITUDE:g}"
        found = f"expected numbers within {limit}, found {table[row, column]:g}"
        raise unreadable_line(numbered[row][0], found)
    return table


def _normalized(line: bytes, columns: int, separator: bytes) -> bytes:
    """The line with exactly `columns` cells, separated by commas, and NaN in empty cells."""
    if separator != b",":
        line = line.replace(b",", b".").replace(separator, b",")
    cells = line.count(b",") + 1
    if cells > columns:
        line = b",".join(line.split(b",", columns)[:columns])
    elif cells < columns:
        line += b"," * (columns - cells)
    # A comma at both ends makes every cell stand between two commas.
    return _MISSING.sub(b"nan", b"," + line + b",")[1:-1]


def _loaded(lines: list[bytes], numbered: Sequence[tuple[int, bytes]], columns: int) -> FloatArray:
    try:
        return np.loadtxt(lines, delimiter=",", ndmin=2, comments=None, encoding="latin-1")
    except ValueError:
        for (number, _), line in zip(numbered, lines, strict=True):
            for cell in line.split(b","):
                _refuse_text(cell, number)
        message = f"expected {columns} numbers on each line"
        raise unreadable_line(numbered[0][0], message) from None


def _refuse_text(cell: bytes, line: int) -> None:
    try:
        float(cell)
    except ValueError:
        raise unreadable_line(line, f"expected a number, found {excerpt(cell)}") from None


def as_points(numbers: FloatArray) -> FloatArray:
    """(rows, points, 3) float32 from (rows, 3 points); NaN where a point was not seen.

    A point is not seen if one of its numbers is missing, or if all three are 0.
    """
    points = numbers.reshape(len(numbers), -1, 3).astype(np.float32)
    seen = np.isfinite(points).all(axis=-1) & (points != 0).any(axis=-1)
    points[~seen] = np.nan
    return points


def rate_of_times(seconds: FloatArray) -> float | None:
    """Hz: the rate of the times (rows,) of frames; None if they do not rise."""
    steps = np.diff(seconds[np.isfinite(seconds)])
    step = float(np.median(steps)) if len(steps) else 0.0
    return 1 / step if step > 0 else None
