"""Reads TRC files (track row column) of markers: bytes in, Recording out.

Cortex, OpenSim, OpenCap and Pose2Sim write them. The second line names the values of the third. The
fourth line has the labels, and the fifth one has X1, Y1, Z1, ... Y is up in OpenSim's axes, but
Cortex also writes Z up, so the motion decides. Sources: the user's manual of Cortex (Motion
Analysis), and OpenSim's "Marker (.trc) files".
"""

from __future__ import annotations

import re

import numpy as np

from app.formats.common.failures import unreadable_line
from app.formats.common.lines import with_plain_newlines
from app.formats.common.units import named_unit
from app.formats.markers.recording import recording_of_markers
from app.formats.markers.tracks import Tracks
from app.formats.tables.cells import as_points, cells_of, rate_of_times, read_numbers, separator_of
from app.motion.skeleton.recording import FRAME_RATES, Caution, Recording
from app.numerics.arrays import FloatArray

HEADER_LINES = 5
_FRAME = re.compile(rb"\s*\"?frame", re.IGNORECASE)
_AXIS = re.compile(r"[XYZ]\d*", re.IGNORECASE)


def read_trc(content: bytes) -> Recording:
    """Read a TRC file.

    Raises Unreadable with the line; Unreadable with the marker and its frames if a marker that a
    joint needs is hidden for too long; and TooLarge.
    """
    lines = with_plain_newlines(content).split(b"\n", HEADER_LINES)
    if len(lines) <= HEADER_LINES or not _FRAME.match(lines[3]):
        raise unreadable_line(4, "expected Frame#, Time and the labels of markers")
    separator = separator_of(lines[3])
    values = _values(lines[1], lines[2])
    labels = _labels(cells_of(lines[3], separator), cells_of(lines[4], separator))
    table = read_numbers(lines[5], HEADER_LINES + 1, 2 + 3 * len(labels), separator)
    if not len(table):
        raise unreadable_line(HEADER_LINES + 1, "expected frames, found none")
    tracks = Tracks(
        labels=labels,
        positions=as_points(table[:, 2:]),
        first_frame=_first_frame(table),
        frame_rate=_frame_rate(values, table),
        up_axis="y",
        metres_per_unit=named_unit(values.get("units", "")),
        cautions=_cautions(values, len(table)),
    )
    return recording_of_markers(tracks, "trc")


def _values(keys: bytes, values: bytes) -> dict[str, str]:
    """The values of the third line by the names in the second line, in lower case."""
    names = [key.lower() for key in cells_of(keys, separator_of(keys))]
    return dict(zip(names, cells_of(values, separator_of(values)), strict=False))


def _labels(cells: list[str], axes: list[str]) -> tuple[str, ...]:
    """(markers,) the labels; empty for a marker without a label. Raises Unreadable.

    Each label is above the X of its marker. Some programs write labels without empty cells between
    them.
    """
    count = sum(1 for cell in axes if _AXIS.fullmatch(cell)) // 3
    above, filled = cells[2::3], [cell for cell in cells[2:] if cell]
    labels = above if len(filled) == len([label for label in above if label]) else filled
    count = count or len(filled)
    if not filled or len(filled) > count:
        raise unreadable_line(4, f"expected {count} labels of markers, found {len(filled)}")
    return tuple(labels[:count]) + ("",) * (count - len(labels))


def _first_frame(table: FloatArray) -> int:
    return int(table[0, 0]) if np.isfinite(table[0, 0]) else 1


def _frame_rate(values: dict[str, str], table: FloatArray) -> float | None:
    declared = _number(values.get("datarate")) or _number(values.get("camerarate"))
    if declared is not None and FRAME_RATES[0] <= declared <= FRAME_RATES[1]:
        return declared
    return rate_of_times(table[:, 1])


def _number(text: str | None) -> float | None:
    try:
        return float((text or "").replace(",", "."))
    except ValueError:
        return None


def _cautions(values: dict[str, str], frames: int) -> tuple[Caution, ...]:
    declared = _number(values.get("numframes"))
    if declared is None or declared == frames:
        return ()
    detail = f"the file declares {declared:g} frames but has {frames}"
    return (Caution("frames_mismatch", detail),)
