"""Square matrices, and matrices over time, as a picture (Sun 2011, figures 3 and 5)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from app.evaluate.charts.drawing import Format, rendered, shown
from app.numerics.arrays import FloatArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIDE = 2.1
"""Inches of a matrix."""
VOLUME = 3.6
"""Inches of a volume."""
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
    """Draw the slices of each volume behind each other, along an axis of time.

    Raises ValueError without a volume.
    """
    import matplotlib

    largest = _largest(volumes)
    colors = matplotlib.colormaps[COLORS]

    def draw(figure: Figure) -> None:
        figure.suptitle(title)
        for number, (name, volume) in enumerate(volumes.items(), 1):
            axes: Any = figure.add_subplot(1, len(volumes), number, projection="3d")
            edges = np.arange(volume.matrices.shape[1] + 1.0)
            across, up = np.meshgrid(edges, edges[::-1])
            for matrix, time in zip(volume.matrices, volume.times, strict=True):
                axes.plot_surface(
                    np.full_like(across, time),
                    across,
                    up,
                    facecolors=colors(matrix / largest),
                    shade=False,
                    rcount=len(edges),
                    ccount=len(edges),
                )
            axes.set(title=shown(name), xlabel="seconds", ylabel="joint", zlabel="joint")
            axes.set_box_aspect((2.2, 1.0, 1.0))
            axes.view_init(elev=18, azim=-62)

    return rendered(draw, (VOLUME * len(volumes) + 0.6, VOLUME), form)


def _largest(rows: Mapping[str, Slices]) -> float:
    """The largest value of all matrices. Raises ValueError without a matrix."""
    if not rows or not all(len(row.times) for row in rows.values()):
        raise ValueError("a picture needs a matrix")
    return max(float(row.matrices.max()) for row in rows.values()) or 1.0
