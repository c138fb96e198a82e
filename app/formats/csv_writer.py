"""Positions as comma-separated values: a row a frame, for spreadsheets and R."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence

import numpy as np

from app.numerics.arrays import FloatArray

DECIMALS = 6
"""Of seconds and meters."""
BLOCK_FRAMES = 1024
_FORMULA_STARTS = ("=", "+", "-", "@")


def write_csv(names: Sequence[str], positions: FloatArray, frame_rate: float) -> Iterator[bytes]:
    """`time` in seconds, then x, y and z of each joint in meters, Y up, piece by piece.

    positions: (frames, joints, 3). The first row names the columns, as `Hips_x`.
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
    """A joint's name that no spreadsheet takes for a formula."""
    return f"'{name}" if name.startswith(_FORMULA_STARTS) else name
