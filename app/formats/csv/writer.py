"""Tables as comma-separated values (RFC 4180), for spreadsheets, pandas and R.

The first row names the columns; a name ends with its unit. Rows end with CR LF. Numbers have a
fixed number of decimals, without trailing zeros of integers. A value that is not known is an empty
field, which pandas reads as NaN. There are no comments.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from app.formats.csv.formulas import guarded
from app.numerics.arrays import FloatArray

Cell = str | int | float | bool | None

DECIMALS = 6
"""Of numbers that are not integers."""

TIME = "time_s"
LINE_END = "\r\n"
BLOCK_ROWS = 1024


def csv_table(columns: Sequence[str], rows: Iterable[Sequence[Cell]]) -> Iterator[bytes]:
    """A table, piece by piece: a row names the columns, then a line a row.

    None and NaN are empty fields. A text never begins like a formula.
    """
    yield _line(columns)
    for row in rows:
        yield _line([_text(cell) for cell in row])


def csv_tracks(
    columns: Sequence[str],
    values: FloatArray,
    frame_rate: float,
    *,
    decimals: int = DECIMALS,
    constants: Sequence[tuple[str, str]] = (),
) -> Iterator[bytes]:
    """Values over time, piece by piece: `time_s`, then a column of `values` (frames, columns).

    frame_rate: Hz. constants: names and values of columns at the end that are the same in each row.
    """
    yield _line([TIME, *columns, *(name for name, _ in constants)])
    pattern = ",".join([f"%.{DECIMALS}f", *[f"%.{decimals}f"] * len(columns)])
    end = _line([value for _, value in constants]).decode() if constants else LINE_END
    tail = f",{end}" if constants else end
    for start in range(0, len(values), BLOCK_ROWS):
        block = values[start : start + BLOCK_ROWS].astype(np.float64)
        times = (start + np.arange(len(block))) / frame_rate
        # + 0.0 makes 0 of -0
        numbers = np.column_stack([times, np.round(block, decimals) + 0.0])
        lines = (pattern % tuple(row) for row in numbers.tolist())
        yield "".join(line.replace("nan", "") + tail for line in lines).encode()


def axis_columns(names: Sequence[str], unit: str) -> list[str]:
    """`Hips_x_m`, `Hips_y_m`, `Hips_z_m`, ... for the x, y and z of each of `names`."""
    return [f"{name}_{axis}_{unit}" for name in names for axis in "xyz"]


def _line(cells: Sequence[str]) -> bytes:
    line = io.StringIO()
    csv.writer(line, lineterminator=LINE_END).writerow([_harmless(cell) for cell in cells])
    return line.getvalue().encode()


class _Number(str):
    """The text of a number, which may begin with a minus sign."""

    __slots__ = ()


def _text(cell: Cell) -> str:
    if cell is None:
        return ""
    if isinstance(cell, bool):
        return "true" if cell else "false"
    if isinstance(cell, int):
        return _Number(cell)
    if isinstance(cell, float):
        return _Number(f"{round(cell, DECIMALS) + 0.0:.{DECIMALS}f}") if math.isfinite(cell) else ""
    return cell


def _harmless(text: str) -> str:
    """A text that no spreadsheet takes for a formula."""
    return text if isinstance(text, _Number) else guarded(text)
