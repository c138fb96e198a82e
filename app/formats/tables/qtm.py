"""TSV files of Qualisys Track Manager with 3-D positions: millimeters, Z up.

Each line of the header is a name and its values. After it there may be a line with the names of the
columns. The numbers may begin with a frame's number and its time. Source: Qualisys Track Manager
user manual, "TSV file formats".
"""

from __future__ import annotations

import re

from app.errors import FormatNotSupported
from app.formats.common.failures import unreadable_line
from app.formats.tables.cells import cells_of
from app.formats.tables.layout import Column, Layout, number_in
from app.kinedex_error import Place

METERS_PER_MILLIMETER = 0.001
MAX_HEADER_LINES = 100
_KEY = re.compile(rb"\s*[A-Z][A-Z_0-9]{3,}\t")
_SEPARATOR = b"\t"


def qtm_layout(text: bytes) -> Layout:
    """The layout of the file; text has plain newlines. Raises Unreadable, FormatNotSupported."""
    header, at, line = _header(text)
    labels = [label for label in header.get("MARKER_NAMES", []) if label]
    if not labels:
        raise _without_markers(header)
    first = text[at:].split(b"\n", 1)[0]
    cells = cells_of(first, _SEPARATOR)
    if all(number_in(cell) is None for cell in cells):
        at, line = at + len(first) + 1, line + 1
        cells = cells_of(text[at:].split(b"\n", 1)[0], _SEPARATOR)
    # A tab may end the line, so a single extra cell is not a column.
    leading = 2 if len(cells) >= 3 * len(labels) + 2 else 0
    frames = number_in(_value(header, "NO_OF_FRAMES"))
    return Layout(
        columns=tuple(Column(label, leading + 3 * n) for n, label in enumerate(labels)),
        separator=_SEPARATOR,
        line=line,
        rows=text[at:],
        frame_rate=number_in(_value(header, "FREQUENCY")),
        metres_per_unit=METERS_PER_MILLIMETER,
        up_axis="z",
        time=1 if leading else None,
        frame=0 if leading else None,
        frames=int(frames) if frames is not None and abs(frames) < 1e9 else None,
    )


def _header(text: bytes) -> tuple[dict[str, list[str]], int, int]:
    """The values of the header by name, the offset of the line after it, and its number."""
    header: dict[str, list[str]] = {}
    at, line = 0, 1
    while _KEY.match(text, at):
        if line > MAX_HEADER_LINES:
            raise unreadable_line(line, f"expected a header of at most {MAX_HEADER_LINES} lines")
        end = text.find(b"\n", at)
        end = len(text) if end < 0 else end
        name, *values = cells_of(text[at:end], _SEPARATOR)
        header.setdefault(name.upper(), values)
        at, line = min(end + 1, len(text)), line + 1
    return header, at, line


def _value(header: dict[str, list[str]], name: str) -> str | None:
    return next(iter(header.get(name, [])), None)


def _without_markers(header: dict[str, list[str]]) -> FormatNotSupported:
    data = _value(header, "DATA_INCLUDED") or "no markers"
    message = f"expected MARKER_NAMES, found a file of {data[:40]}"
    return FormatNotSupported(
        "This TSV file of Qualisys has no markers. Export 3D data, or a C3D file.",
        places=[Place("MARKER_NAMES", message)],
    )
