"""Writes TRC files for tests, and reads them as OpenSim does."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from app.numerics.arrays import FloatArray

KEYS = [
    "DataRate", "CameraRate", "NumFrames", "NumMarkers", "Units", "OrigDataRate",
    "OrigDataStartFrame", "OrigNumFrames",
]  # fmt: skip


def opensim(content: bytes) -> tuple[dict[str, str], list[str], FloatArray, FloatArray]:
    """Metadata, labels, times (n,) and positions (n, markers, 3), as OpenSim reads a file: cells
    are separated by tabs, empty cells of the head are dropped, each row has all its cells."""
    lines = content.decode().split("\n")
    cells = [line.split("\t") for line in lines]
    filled = [[cell for cell in row if cell] for row in cells]
    assert filled[0][0] == "PathFileType"
    assert filled[1] == KEYS
    meta = dict(zip(filled[1], filled[2], strict=True))
    frame, time, *labels = filled[3]
    assert (frame, time) == ("Frame#", "Time")
    markers = int(meta["NumMarkers"])
    assert len(labels) == markers
    assert filled[4] == [f"{axis}{n}" for n in range(1, markers + 1) for axis in "XYZ"]
    assert lines[5] == ""
    assert lines[-1] == ""
    rows = np.array(cells[6:-1], dtype=float).reshape(-1, 2 + 3 * markers)
    np.testing.assert_array_equal(rows[:, 0], np.arange(1, len(rows) + 1))
    assert len(rows) == int(meta["NumFrames"])
    return meta, labels, rows[:, 1], rows[:, 2:].reshape(len(rows), markers, 3)


def trc(
    positions: FloatArray,
    labels: Sequence[str],
    *,
    rate: float = 100.0,
    unit: str = "mm",
    separator: str = "\t",
    hidden: str = "",
    newline: str = "\n",
    values: Mapping[str, str] | None = None,
) -> bytes:
    """A TRC file of positions (frames, markers, 3); NaN is written as `hidden`.

    values: replaces values of the header, by their names.
    """
    frames, markers = positions.shape[:2]
    written = {
        "DataRate": f"{rate:g}", "CameraRate": f"{rate:g}", "NumFrames": str(frames),
        "NumMarkers": str(markers), "Units": unit, "OrigDataRate": f"{rate:g}",
        "OrigDataStartFrame": "1", "OrigNumFrames": str(frames),
    } | dict(values or {})  # fmt: skip
    named = [cell for label in labels for cell in (label, "", "")]
    axes = [f"{axis}{number}" for number in range(1, markers + 1) for axis in "XYZ"]
    lines = [
        separator.join(("PathFileType", "4", "(X/Y/Z)", "walk.trc")),
        separator.join(written),
        separator.join(written.values()),
        separator.join(("Frame#", "Time", *named)),
        separator.join(("", "", *axes)),
        "",
    ]
    for frame, row in enumerate(positions.reshape(frames, -1)):
        cells = (hidden if np.isnan(number) else repr(float(number)) for number in row)
        lines.append(separator.join((str(frame + 1), f"{frame / rate:.6f}", *cells)))
    return (newline.join(lines) + newline).encode()
