"""Annotations as comma-separated values: clip, start, end, words, person, text, by.

Times are seconds. Words are separated by spaces; a phrase has underscores (`left_leg`). Only the
columns start and end are needed. A spreadsheet may write semicolons or tabs.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from app.errors import TooLarge, Unreadable
from app.formats.annotations.span import MAX_FILE_BYTES, Span
from app.formats.csv.formulas import unguarded
from app.formats.csv.writer import csv_table
from app.kinedex_error import Place

COLUMNS = ("clip", "start", "end", "words", "person", "text", "by")
MAX_ROWS = 200_000
"""Rows of one file, which may hold the annotations of many clips."""
_SEPARATORS = ",;\t"


def write_table(rows: Iterable[tuple[str, Span]]) -> bytes:
    """A CSV file of spans, each with the name of its clip."""
    return b"".join(csv_table(COLUMNS, (_cells(clip, span) for clip, span in rows)))


def read_table(content: bytes) -> list[tuple[str, Span]]:
    """The spans of a CSV file, each with the name of its clip ("" without one).

    Raises Unreadable with the line, and TooLarge beyond MAX_ROWS or MAX_FILE_BYTES.
    """
    if len(content) > MAX_FILE_BYTES:
        raise TooLarge(f"A table of annotations has at most {MAX_FILE_BYTES} bytes.")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as problem:
        line = content[: problem.start].count(b"\n") + 1
        raise _unreadable(line, "not UTF-8 text") from problem
    separator = max(_SEPARATORS, key=text.partition("\n")[0].count)
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=separator, strict=True)
    try:
        return list(_rows(reader))
    except csv.Error as problem:
        raise _unreadable(max(reader.line_num, 1), str(problem)) from problem


def _rows(reader: Iterator[list[str]]) -> Iterator[tuple[str, Span]]:
    line = 1
    names: list[str] | None = None
    for number, cells in enumerate(reader):
        line = getattr(reader, "line_num", number + 1)
        if names is None:
            names = _header(cells, line)
        elif any(cell.strip() for cell in cells):
            if number > MAX_ROWS:
                raise TooLarge(f"A table of annotations has at most {MAX_ROWS} rows.")
            yield _row(dict(zip(names, map(str.strip, cells), strict=False)), line)
    if names is None:
        raise _unreadable(1, "the first line must name the columns")


def _header(cells: Sequence[str], line: int) -> list[str]:
    names = [cell.strip().lower() for cell in cells]
    unknown = sorted({*names} - {*COLUMNS, ""})
    if unknown:
        raise _unreadable(line, f"{unknown[0]!r:.80} is no column; they are {', '.join(COLUMNS)}")
    missing = [name for name in ("start", "end") if name not in names]
    if missing:
        raise _unreadable(line, f"the column {missing[0]} is missing")
    if len({*names} - {""}) < len([name for name in names if name]):
        raise _unreadable(line, "a column is there twice")
    return names


def _row(cells: dict[str, str], line: int) -> tuple[str, Span]:
    texts = {name: unguarded(cells.get(name, "")) for name in COLUMNS}
    span = Span(
        start=_seconds(texts["start"], "start", line),
        end=_seconds(texts["end"], "end", line),
        words=tuple(texts["words"].split()),
        person=texts["person"] or None,
        text=texts["text"] or None,
        by=texts["by"] or None,
    )
    return texts["clip"], replace(span, place=f"line {line}")


def _seconds(cell: str, name: str, line: int) -> float:
    try:
        # A decimal comma is how spreadsheets of many countries write 1.5.
        number = float(cell.replace(",", "."))
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise _unreadable(line, f"{name} must be seconds, found {cell!r:.80}")
    return number


def _cells(clip: str, span: Span) -> tuple[str | float, ...]:
    words = " ".join(span.words)
    return clip, span.start, span.end, words, span.person or "", span.text or "", span.by or ""


def _unreadable(line: int, message: str) -> Unreadable:
    place = Place(f"line {line}", message)
    return Unreadable(f"The table cannot be read: line {line}: {message}.", places=[place])
