"""Writes positions as comma-separated values (CSV), one row for each frame."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence

import numpy as np

from app.numerics.arrays import FloatArray

DECIMALS = 6
"""Decimals of seconds and meters."""
BLOCK_FRAMES = 1024
"""Frames that are converted to text at once."""
_FORMULA_STARTS = ("=", "+", "-", "@")


def write_csv(names: Sequence[str], positions: FloatArray, frame_rate: float) -> Iterator[bytes]:
    """The bytes of a CSV file, in blocks of frames.

    names: (joints,). positions: (frames, joints, 3) meters, Y up. frame_rate: Hz. The first row has
    the names of the columns: `time` (seconds), then for example `Hips_x`, `Hips_y`, `Hips_z`.
    """
    head = io.StringIO()
    columns = [f"{_harmless(name)}_{axis}" for name in names for axis in "xyz"]
    csv.writer(head, lineterminator="\n").writerow(["time", *columns])
    yield head.getvalue().encode()
    pattern = ",".join([f"%.{DECIMALS}f"] * (1 + len(columns)))
    for start in range(0, len(positions), BLOCK_FRAMES):
        block = positions[start : start + BLOCK_FRAMES].astype(np.float64)
        times = (start + np.arange(len(block))) / frame_rate
        rows = np.column_stack([times, block.reshape(len(block), -1)]).tolist()
        yield ("\n".join(pattern % tuple(row) for row in rows) + "\n").encode()


def _harmless(name: str) -> str:
    """The name of a joint in a form that spreadsheets do not run as a formula."""
    return f"'{name}" if name.startswith(_FORMULA_STARTS) else name
