"""What the header of a table says: which columns are the points, and where the numbers begin."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.formats.common.failures import unreadable_line
from app.formats.markers.tracks import Tracks
from app.formats.tables.cells import as_points, rate_of_times, read_numbers
from app.motion.skeleton.recording import FRAME_RATES, Caution
from app.numerics.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Column:
    """A point of a table: its label, and the column of its X. Y and Z follow."""

    label: str
    x: int


@dataclass(frozen=True, slots=True)
class Layout:
    """A table of points.

    columns: of the points. separator: of the cells. line: the number of the first line of `rows`.
    rows: the text of the numbers. frame_rate: Hz, None if the header gives none. time: the column
    of the seconds, None without one. frame: the column of the frame's number. frames: the number of
    frames that the header declares, or None.
    """

    columns: tuple[Column, ...]
    separator: bytes
    line: int
    rows: bytes
    frame_rate: float | None
    metres_per_unit: float | None
    up_axis: str
    time: int | None = None
    frame: int | None = None
    frames: int | None = None

    def tracks(self) -> Tracks:
        """The points. Raises Unreadable with the line, and TooLarge."""
        width = max(column.x for column in self.columns) + 3
        table = read_numbers(self.rows, self.line, width, self.separator)
        if not len(table):
            raise unreadable_line(self.line, "expected frames, found none")
        used = [column.x + axis for column in self.columns for axis in range(3)]
        return Tracks(
            labels=tuple(column.label for column in self.columns),
            positions=as_points(table[:, used]),
            first_frame=self._first_frame(table),
            frame_rate=self._rate(table),
            up_axis=self.up_axis,
            metres_per_unit=self.metres_per_unit,
            cautions=self._cautions(len(table)),
        )

    def _first_frame(self, table: FloatArray) -> int:
        number = 1.0 if self.frame is None else float(table[0, self.frame])
        return int(number) if np.isfinite(number) else 1

    def _rate(self, table: FloatArray) -> float | None:
        declared = self.frame_rate
        if declared is not None and FRAME_RATES[0] <= declared <= FRAME_RATES[1]:
            return declared
        return None if self.time is None else rate_of_times(table[:, self.time])

    def _cautions(self, frames: int) -> tuple[Caution, ...]:
        if self.frames in (None, frames):
            return ()
        detail = f"the file declares {self.frames} frames but has {frames}"
        return (Caution("frames_mismatch", detail),)


def positions_in(axes: Sequence[str], labels: Sequence[str]) -> tuple[Column, ...]:
    """The points of a table: each run of the axes X, Y and Z with the label above its X.

    axes, labels: (cells,) the cells of two lines of a header.
    """
    upper = [axis.upper() for axis in axes]
    return tuple(
        Column(labels[x] if x < len(labels) else "", x)
        for x in range(len(upper) - 2)
        if upper[x : x + 3] == ["X", "Y", "Z"]
    )


def number_in(text: str | None) -> float | None:
    """The number in a cell of a header; None if there is none."""
    try:
        return float((text or "").replace(",", "."))
    except ValueError:
        return None
