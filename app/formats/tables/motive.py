"""CSV files of OptiTrack Motive: bones of a skeleton, or markers.

The first line has names and values in turn. Then come lines that give the type, the name, the ID,
the parent and the kind (Rotation, Position) of each column, and a line of axes. A skeleton's bones
are read if there are enough of them, else the markers. Y is up. Source: OptiTrack's documentation,
"Data export: CSV".
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from app.errors import FormatNotSupported
from app.formats.common.failures import unreadable_line
from app.formats.common.names import without_common_prefix
from app.formats.common.units import named_unit
from app.formats.tables.cells import cells_of
from app.formats.tables.layout import Column, Layout, number_in, positions_in
from app.kinedex_error import Place

MAX_HEADER_LINES = 20
MIN_BONES = 8
"""The fewest bones of a person's skeleton."""
_SEPARATOR = b","
_TITLES = ("type", "name", "id", "parent")


def motive_layout(text: bytes) -> Layout:
    """The layout of the file; text has plain newlines. Raises Unreadable, FormatNotSupported."""
    lines = text.split(b"\n", MAX_HEADER_LINES)
    head = [cells_of(line, _SEPARATOR) for line in lines[:MAX_HEADER_LINES]]
    at = next((n for n, cells in enumerate(head) if cells[0].lower() == "frame"), None)
    if at is None or at < 2:
        raise unreadable_line(1, "expected a line that begins with Frame, found none")
    titled = {title: cells for cells in head[:at] if (title := _title(cells))}
    columns = _positions(head[at], head[at - 1], titled.get("name", ()))
    types = [*titled.get("type", ()), *[""] * len(head[at])]
    values = _values(head[0])
    bones = _bones(columns, types)
    if bones:
        _refuse_local(values)
    chosen = bones or _markers(columns, types)
    if not chosen:
        raise unreadable_line(at + 1, "expected positions of bones or markers, found none")
    return Layout(
        columns=tuple(chosen),
        separator=_SEPARATOR,
        line=at + 2,
        rows=b"\n".join(lines[at + 1 :]),
        frame_rate=_rate(values),
        metres_per_unit=named_unit(values.get("length units", "")),
        up_axis="y",
        time=1,
        frame=0,
        frames=_frames(values),
    )


def _positions(axes: Sequence[str], kinds: Sequence[str], names: Sequence[str]) -> list[Column]:
    """The columns of positions. Rotations also have the axes X, Y and Z."""
    return [
        column
        for column in positions_in(axes, names)
        if column.x < len(kinds) and kinds[column.x].lower().startswith("position")
    ]


def _refuse_local(values: Mapping[str, str]) -> None:
    if values.get("coordinate space", "").lower() == "local":
        raise FormatNotSupported(
            "The bones of this Motive CSV file are relative to their parents. Export them in"
            " global coordinates.",
            places=[Place("line 1", "expected the coordinate space Global, found Local")],
        )


def _title(cells: Sequence[str]) -> str | None:
    """The title of a line of the header, which is in one of its first cells."""
    return next((cell.lower() for cell in cells[:3] if cell.lower() in _TITLES), None)


def _values(cells: Sequence[str]) -> dict[str, str]:
    """The values of the first line by their names in lower case."""
    return {name.lower(): value for name, value in zip(cells[::2], cells[1::2], strict=False)}


def _bones(columns: Sequence[Column], types: Sequence[str]) -> list[Column]:
    """The bones with their names alone, if they are enough for a person."""
    bones = [column for column in columns if types[column.x].lower() == "bone"]
    if len(bones) < MIN_BONES:
        return []
    labels = without_common_prefix([bone.label for bone in bones])
    return [Column(label, bone.x) for label, bone in zip(labels, bones, strict=True)]


def _markers(columns: Sequence[Column], types: Sequence[str]) -> list[Column]:
    """The markers as seen; without any, the markers of the skeleton as solved."""
    for kind in ("marker", "bone marker", "rigid body marker"):
        found = [column for column in columns if types[column.x].lower() == kind]
        if found:
            return found
    return []


def _rate(values: Mapping[str, str]) -> float | None:
    rates = (number_in(values.get(f"{name} frame rate")) for name in ("export", "capture"))
    return next((rate for rate in rates if rate), None)


def _frames(values: Mapping[str, str]) -> int | None:
    names = ("total exported frames", "total frames in take")
    found = next((number_in(values[name]) for name in names if name in values), None)
    return int(found) if found is not None and abs(found) < 1e9 else None
