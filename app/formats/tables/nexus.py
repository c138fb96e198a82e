"""The section `Trajectories` of a CSV file of Vicon Nexus or Workstation.

The lines of a section are its name, its rate in Hz, the labels, the axes, and the units (not in
Workstation). A blank line ends it. Other sections (`Devices`, `Model Outputs`) are not read.
Source: Vicon Nexus user guide, "ASCII export".
"""

from __future__ import annotations

import re

from app.formats.common.failures import unreadable_line
from app.formats.common.units import named_unit
from app.formats.tables.cells import cells_of, separator_of
from app.formats.tables.layout import Layout, number_in, positions_in

START = re.compile(rb"^\"?trajectories\"?[,;\t \"]*$", re.IGNORECASE | re.MULTILINE)
_END = re.compile(rb"^[,;\t \"]*$", re.MULTILINE)
HEADER_LINES = 4


def nexus_layout(text: bytes) -> Layout:
    """The layout of the section; text has plain newlines. Raises Unreadable with the line."""
    start = START.search(text)
    if start is None:
        raise unreadable_line(1, "expected a section Trajectories, found none")
    line = text.count(b"\n", 0, start.start()) + 1
    rate, labels, axes, *rest = [*text[start.end() + 1 :].split(b"\n", HEADER_LINES - 1), b"", b""]
    separator = separator_of(axes)
    cells = cells_of(axes, separator)
    columns = positions_in(cells, cells_of(labels, separator))
    if not columns:
        raise unreadable_line(line + 3, "expected the axes X, Y, Z of markers, found none")
    rows, line = rest[0], line + HEADER_LINES
    units = cells_of(rows.split(b"\n", 1)[0], separator)
    unit = units[columns[0].x] if len(units) > columns[0].x else ""
    if number_in(unit) is None and named_unit(unit):
        rows, line = rows.partition(b"\n")[2], line + 1
    end = _END.search(rows)
    return Layout(
        columns=columns,
        separator=separator,
        line=line,
        rows=rows[: end.start()] if end else rows,
        frame_rate=number_in(cells_of(rate, separator_of(rate))[0]),
        metres_per_unit=named_unit(unit) or 0.001,
        up_axis="z",
        frame=0,
    )
