"""TRC files as OpenSim reads them."""

from __future__ import annotations

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
