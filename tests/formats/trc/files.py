"""Writes TRC files for tests."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from app.numerics.arrays import FloatArray


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
