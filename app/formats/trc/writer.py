"""Positions as a TRC file, which OpenSim reads: a marker is a joint.

The axes are those of OpenSim's models: Y up, right-handed. Source: OpenSim's `TRCFileAdapter`: five
lines of header and an empty one, then a line a frame; cells are separated by tabs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from app.formats.common.marker_labels import marker_labels
from app.numerics.arrays import FloatArray

DECIMALS = 6
"""Of seconds and of positions in the file's unit."""

BLOCK_FRAMES = 1024
_KEYS = (
    "DataRate", "CameraRate", "NumFrames", "NumMarkers", "Units", "OrigDataRate",
    "OrigDataStartFrame", "OrigNumFrames",
)  # fmt: skip


def write_trc(
    names: Sequence[str],
    positions: FloatArray,
    frame_rate: float,
    *,
    unit: str = "mm",
    units_per_meter: float = 1000.0,
    file_name: str = "motion.trc",
) -> Iterator[bytes]:
    """A TRC file of positions (frames, joints, 3) in meters, Y up, piece by piece.

    names: (joints,); labels are made of them by `marker_labels`. frame_rate: Hz. unit: its name in
    the file.
    """
    frames, joints = positions.shape[:2]
    rate = f"{frame_rate:.9g}"
    values = (rate, rate, str(frames), str(joints), unit, rate, "1", str(frames))
    axes = "\t".join(f"{axis}{number}" for number in range(1, joints + 1) for axis in "XYZ")
    head = [
        "\t".join(("PathFileType", "4", "(X/Y/Z)", _one_cell(file_name))),
        "\t".join(_KEYS),
        "\t".join(values),
        "\t".join(("Frame#", "Time", "\t\t\t".join(marker_labels(names)))) + "\t\t",
        f"\t\t{axes}",
        "",
    ]
    yield ("\n".join(head) + "\n").encode()
    number = f"%.{DECIMALS}f"
    pattern = "\t".join(["%d", *[number] * (1 + 3 * joints)]) + "\n"
    for start in range(0, frames, BLOCK_FRAMES):
        block = positions[start : start + BLOCK_FRAMES].astype(np.float64) * units_per_meter
        counts = start + np.arange(len(block))
        rounded = np.round(block.reshape(len(block), -1), DECIMALS) + 0.0
        rows = np.column_stack([counts + 1, counts / frame_rate, rounded]).tolist()
        yield "".join(pattern % tuple(row) for row in rows).encode()


def _one_cell(text: str) -> str:
    return "".join(char if char.isprintable() else "_" for char in text)
