"""Reads the table of a manifest row by row, with at most one row in memory.

Each row has limits (columns, characters), and all manifests of an import together have limits
(rows, bytes). So a small archive cannot unpack to a table that fills the memory.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Protocol

from app.errors import TooLarge, Unreadable
from app.kinedex_error import Place
from app.services.imports.columns import BadColumn, Columns

MANIFEST_NAME = "manifest.csv"
MAX_BYTES = 64 * 2**20
"""Bytes of all manifests of one import: 100,000 rows of 600 bytes each."""
MAX_COLUMNS = 100
MAX_ROW = 2**20
"""Characters of one row. Python's csv module reads at most 131,072 characters in one cell."""
_SEPARATORS = ",;\t"


class Readable(Protocol):
    """An open file of bytes."""

    def read(self, size: int, /) -> bytes:
        """The next bytes, at most `size`; empty at the end."""
        ...


@dataclass(frozen=True, slots=True)
class ManifestLimits:
    """Limits for all manifests of one import together."""

    rows: int
    bytes: int = MAX_BYTES


@dataclass(slots=True)
class ManifestUsage:
    """The rows and bytes of all manifests that were read so far, with their limits."""

    limits: ManifestLimits
    rows: int = 0
    bytes: int = 0


def read_rows(
    content: Readable, usage: ManifestUsage, expected: Collection[str]
) -> Iterator[tuple[Columns, int, list[str]]]:
    """The rows that have a path: the columns of the manifest, the line, and the row's cells.

    usage: counts the rows and bytes; expected: names of fields to look for. Raises Unreadable
    if the content is not a table with a column of paths, or if the name of a column cannot be
    used, and TooLarge beyond a limit; both name the line.
    """
    lines = _Lines(content, usage)
    reader = csv.reader(lines, delimiter=lines.separator(), skipinitialspace=True, strict=True)
    columns: Columns | None = None
    try:
        for cells in reader:
            line = reader.line_num
            lines.begin_row(is_counted=columns is not None)
            if len(cells) > MAX_COLUMNS:
                raise _too_large(line, f"more than {MAX_COLUMNS} columns")
            if columns is None:
                columns = Columns(cells, expected)
                if "path" not in columns:
                    break
            elif columns.cell(cells, "path"):
                yield columns, line, cells
    except (csv.Error, BadColumn) as problem:
        raise _unreadable(max(reader.line_num, 1), str(problem)) from problem
    if columns is None or "path" not in columns:
        raise _unreadable(1, "the first line must name the columns, and one must be `path`")


def too_long_path(line: int, limit: int) -> TooLarge:
    """The error for a manifest with a path of more than `limit` characters."""
    return _too_large(line, f"a path of more than {limit} characters")


class _Lines:
    """The lines of a manifest. Each line is checked before the csv module gets it."""

    def __init__(self, content: Readable, usage: ManifestUsage) -> None:
        self._usage = usage
        raw = io.BufferedReader(_Counted(content, usage, self))
        # surrogateescape: so that `_next` can name the line with bytes that are not UTF-8.
        self._text = io.TextIOWrapper(raw, "utf-8-sig", errors="surrogateescape", newline="")
        self.number = 0
        self._in_row = 0
        self._first: str | None = self._next()

    def separator(self) -> str:
        """The separator that is most frequent in the first line; a comma if there is none."""
        # Spreadsheet programs write semicolons in countries with a decimal comma.
        return max(_SEPARATORS, key=(self._first or "").count)

    def begin_row(self, *, is_counted: bool) -> None:
        """Count a complete row. The next line begins another row. Empty rows count too."""
        self._in_row = 0
        self._usage.rows += is_counted
        if self._usage.rows > self._usage.limits.rows:
            raise _too_large(self.number, f"more than {self._usage.limits.rows} rows")

    def __iter__(self) -> _Lines:
        return self

    def __next__(self) -> str:
        line, self._first = self._first or self._next(), None
        if not line:
            raise StopIteration
        return line

    def _next(self) -> str:
        line = self._text.readline(MAX_ROW + 1)
        self.number += 1
        self._in_row += len(line)
        if self._in_row > MAX_ROW:
            raise _too_large(self.number, f"a row of more than {MAX_ROW} characters")
        try:
            line.encode()
        except UnicodeEncodeError as problem:
            raise _unreadable(self.number, "not UTF-8 text") from problem
        return line


class _Counted(io.RawIOBase):
    """The bytes of a manifest, counted during reading."""

    def __init__(self, content: Readable, usage: ManifestUsage, lines: _Lines) -> None:
        self._content, self._usage, self._lines = content, usage, lines

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: memoryview) -> int:  # type: ignore[override]
        chunk = self._content.read(len(buffer))
        self._usage.bytes += len(chunk)
        if self._usage.bytes > self._usage.limits.bytes:
            limit = self._usage.limits.bytes
            raise _too_large(self._lines.number, f"more than {limit} bytes of manifests")
        buffer[: len(chunk)] = chunk
        return len(chunk)


def _unreadable(line: int, message: str) -> Unreadable:
    place = Place(f"{MANIFEST_NAME} line {line}", message)
    return Unreadable(f"{MANIFEST_NAME} cannot be read: line {line}: {message}.", places=[place])


def _too_large(line: int, message: str) -> TooLarge:
    line = max(line, 1)
    place = Place(f"{MANIFEST_NAME} line {line}", message)
    return TooLarge(f"{MANIFEST_NAME} is too large: line {line}: {message}.", places=[place])
