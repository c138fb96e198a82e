"""The table in a manifest, read row by row: never more of it in memory than one row.

Each row has limits (columns, characters), and so have all manifests of an import together (rows,
bytes), so that a small archive cannot unpack to a table that fills the memory.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol

from app.errors import Place, TooLarge, Unreadable

MANIFEST_NAME = "manifest.csv"
MAX_BYTES = 64 * 2**20
"""Of all manifests of one import: 100,000 rows of 600 bytes each."""
MAX_COLUMNS = 100
MAX_ROW = 2**20
"""Characters of one row. Python's csv module takes at most 131,072 in one field of it."""
_SEPARATORS = ",;\t"


class Readable(Protocol):
    """Anything that gives bytes."""

    def read(self, size: int, /) -> bytes:
        """At most `size` bytes; none at the end."""
        ...


@dataclass(frozen=True, slots=True)
class ManifestLimits:
    """Limits for all manifests of one import together."""

    rows: int
    bytes: int = MAX_BYTES


@dataclass(slots=True)
class Used:
    """How much of the limits the manifests read so far have used."""

    limits: ManifestLimits
    rows: int = 0
    bytes: int = 0


class Columns:
    """Where the columns of a manifest are; one object for each manifest."""

    def __init__(self, header: Sequence[str], known: Collection[str]) -> None:
        at = {name.strip().lower(): index for index, name in enumerate(header)}
        self._at = at
        self.names = tuple(name for name in known if name in at)
        self._known = tuple(at[name] for name in self.names)

    def __contains__(self, name: str) -> bool:
        return name in self._at

    def of(self, cells: Sequence[str], name: str) -> str:
        """The cell of a column; empty where there is none."""
        index = self._at.get(name, len(cells))
        return cells[index].strip() if index < len(cells) else ""

    def known(self, cells: Sequence[str]) -> tuple[str, ...]:
        """The cells of the known columns, in the order of `names`."""
        count = len(cells)
        return tuple(cells[i].strip() if i < count else "" for i in self._known)


def read_rows(
    content: Readable, used: Used, known: Collection[str]
) -> Iterator[tuple[Columns, int, list[str]]]:
    """The rows that name a path: the manifest's columns, the line, and the row's cells.

    Counts in `used`. Raises Unreadable where it is no table of paths, TooLarge beyond a limit;
    both name the line.
    """
    lines = _Lines(content, used)
    reader = csv.reader(lines, delimiter=lines.separator(), skipinitialspace=True, strict=True)
    columns: Columns | None = None
    try:
        for cells in reader:
            line = reader.line_num
            lines.begin_row(is_counted=columns is not None)
            if len(cells) > MAX_COLUMNS:
                raise _too_large(line, f"more than {MAX_COLUMNS} columns")
            if columns is None:
                columns = Columns(cells, known)
                if "path" not in columns:
                    break
            elif columns.of(cells, "path"):
                yield columns, line, cells
    except csv.Error as problem:
        raise _unreadable(max(reader.line_num, 1), str(problem)) from problem
    if columns is None or "path" not in columns:
        raise _unreadable(1, "the first line must name the columns, `path` among them")


def too_long_path(line: int, most: int) -> TooLarge:
    """The refusal of a manifest with a path of more than `most` characters."""
    return _too_large(line, f"a path of more than {most} characters")


class _Lines:
    """The lines of a manifest, each checked before it is handed on."""

    def __init__(self, content: Readable, used: Used) -> None:
        self._used = used
        raw = io.BufferedReader(_Counted(content, used, self))
        # surrogateescape: bytes that are no UTF-8 are found in the line that holds them.
        self._text = io.TextIOWrapper(raw, "utf-8-sig", errors="surrogateescape", newline="")
        self.number = 0
        self._in_row = 0
        self._first: str | None = self._next()

    def separator(self) -> str:
        """What separates the cells of the first line."""
        # Spreadsheets of many countries write semicolons; a tie is a table of one column.
        return max(_SEPARATORS, key=(self._first or "").count)

    def begin_row(self, *, is_counted: bool) -> None:
        """A row is complete, the next line begins another. Blank rows count, too."""
        self._in_row = 0
        self._used.rows += is_counted
        if self._used.rows > self._used.limits.rows:
            raise _too_large(self.number, f"more than {self._used.limits.rows} rows")

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
    """The bytes of a manifest, counted as they are read."""

    def __init__(self, content: Readable, used: Used, lines: _Lines) -> None:
        self._content, self._used, self._lines = content, used, lines

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: memoryview) -> int:  # type: ignore[override]
        chunk = self._content.read(len(buffer))
        self._used.bytes += len(chunk)
        if self._used.bytes > self._used.limits.bytes:
            most = self._used.limits.bytes
            raise _too_large(self._lines.number, f"more than {most} bytes of manifests")
        buffer[: len(chunk)] = chunk
        return len(chunk)


def _unreadable(line: int, message: str) -> Unreadable:
    place = Place(f"{MANIFEST_NAME} line {line}", message)
    return Unreadable(f"{MANIFEST_NAME} cannot be read: {message}.", places=[place])


def _too_large(line: int, message: str) -> TooLarge:
    line = max(line, 1)
    place = Place(f"{MANIFEST_NAME} line {line}", message)
    return TooLarge(f"{MANIFEST_NAME} is too large: line {line}: {message}.", places=[place])
