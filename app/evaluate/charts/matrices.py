"""Square matrices, and matrices over time, as a picture (Sun 2011, figures 3 and 5)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from app.evaluate.charts.drawing import Format, rendered, shown
from app.numerics.arrays import FloatArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIDE = 2.1
"""Inches of a matrix."""
VOLUME = (8.4, 2.5)
"""Width and height of a volume, in inches."""
STEP, RISE = 7.0, 0.6
"""Cells between two slices of a volume, to the right and upward."""
SHEAR, FLATTENED = 0.35, 0.5
"""How a slice is seen from the side: its width is FLATTENED, its right side higher by SHEAR."""
COLORS = "Blues"


@dataclass(frozen=True, slots=True)
class Slices:
    """Matrices (s, n, n) at `times` (s,), in seconds."""

    matrices: FloatArray
    times: FloatArray


def matrices_picture(
    rows: Mapping[str, Slices], names: Sequence[str], form: Format, *, title: str, label: str
) -> bytes:
    """Draw each matrix of each row; `names` (n,) of the cells; label: of the colors.

    Raises ValueError without a row.
    """
    largest = _largest(rows)
    across = max(len(row.times) for row in rows.values())

    def draw(figure: Figure) -> None:
        figure.suptitle(title)
        axes = figure.subplots(len(rows), across, squeeze=False)
        for down, (name, row) in enumerate(rows.items()):
            for column in range(across):
                place = axes[down, column]
                place.set_axis_off()
                if column >= len(row.times):
                    continue
                place.set_axis_on()
                mesh = place.pcolormesh(row.matrices[column], cmap=COLORS, vmin=0.0, vmax=largest)
                place.set(title=f"{shown(name)}, {row.times[column]:.2f} s", aspect="equal")
                place.invert_yaxis()
                place.grid(visible=False)
                middles = np.arange(len(names)) + 0.5
                place.set_yticks(middles, names if column == 0 else [""] * len(names))
                last = down == len(rows) - 1
                place.set_xticks(middles, names if last else [""] * len(names), rotation=90)
                place.tick_params(length=0, labelsize=6)
        figure.colorbar(mesh, ax=axes, shrink=0.6, aspect=30, pad=0.02, label=label)

    return rendered(draw, (SIDE * across + 2.0, SIDE * len(rows) + 1.2), form)


def volumes_picture(volumes: Mapping[str, Slices], form: Format, *, title: str) -> bytes:
    """Draw the slices of each volume, seen from the side, one behind the other as time goes on.

    Raises ValueError without a volume.
    """
    from matplotlib.transforms import Affine2D

    largest = _largest(volumes)

    def draw(figure: Figure) -> None:
        figure.suptitle(title)
        for number, (name, volume) in enumerate(volumes.items(), 1):
            axes = figure.add_subplot(len(volumes), 1, number)
            count, side = len(volume.times), volume.matrices.shape[1]
            # the last slice is the farthest, so it is drawn first
            for index in reversed(range(count)):
                x, y = STEP * index, RISE * index
                seen = Affine2D.from_values(FLATTENED, SHEAR * FLATTENED, 0.0, 1.0, x, y)
                axes.pcolormesh(
                    volume.matrices[index][::-1],
                    cmap=COLORS,
                    vmin=0.0,
                    vmax=largest,
                    transform=seen + axes.transData,
                )
                axes.text(x, y - 1.6, f"{volume.times[index]:.2f} s", size=6)
            axes.set(
                xlim=(0.0, STEP * (count - 1) + FLATTENED * side),
                ylim=(-2.0, RISE * (count - 1) + (1.0 + SHEAR * FLATTENED) * side),
                aspect="equal",
            )
            axes.set_title(shown(name), loc="left")
            axes.set_axis_off()

    return rendered(draw, (VOLUME[0], VOLUME[1] * len(volumes) + 0.4), form)


def _largest(rows: Mapping[str, Slices]) -> float:
    """The largest value of all matrices. Raises ValueError without a matrix."""
    if not rows or not all(len(row.times) for row in rows.values()):
        raise ValueError("a picture needs a matrix")
    return max(float(row.matrices.max()) for row in rows.values()) or 1.0
