"""A confusion matrix as a picture (Sun 2011, figure 8)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from app.evaluate.charts.drawing import MAX_INCHES, Format, drawn, shown
from app.numerics.arrays import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import QuadMesh
    from matplotlib.figure import Figure

CELL = 0.42
"""Inches; cells shrink when there are more than MAX_FULL_SIZE classes."""
MAX_FULL_SIZE = 30
MAX_NUMBERED = 60
USUAL_LETTERS = 9.0
"""Points; names are smaller where that is more than a cell is high."""
LETTERS_A_CELL = 0.75 * 72
"""Points of an inch of cell: lines of names stand apart."""
DARK = 0.55
"""Cells of a larger share carry white numbers."""


def confusion_picture(
    shares: FloatArray,
    classes: Sequence[str],
    form: Format,
    *,
    title: str = "",
    rows: str = "true class",
    columns: str = "taken for",
) -> bytes:
    """`shares` (classes, classes), 0..1, one row a true class; numbers are per cent.

    Raises ValueError when the shapes do not fit.
    """
    return confusions_picture({title: shares}, classes, form, rows=rows, columns=columns)


def confusions_picture(
    by_title: Mapping[str, FloatArray],
    classes: Sequence[str],
    form: Format,
    *,
    rows: str = "true class",
    columns: str = "taken for",
) -> bytes:
    """Matrices of the same classes beside one another, as in figure 8; else as for one."""
    count = len(classes)
    if not count or not by_title or {m.shape for m in by_title.values()} != {(count, count)}:
        raise ValueError("a confusion matrix has one row and one column a class")
    side = CELL * max(min(count, MAX_FULL_SIZE), 4) + 0.2 * max(count - MAX_FULL_SIZE, 0)
    width, height = (side + 0.3) * len(by_title) + 2.6, side + 1.6
    fitting = min(1.0, MAX_INCHES / width, MAX_INCHES / height)
    letters = min(USUAL_LETTERS, LETTERS_A_CELL * fitting * side / count)

    def draw(figure: Figure) -> None:
        for place, (title, shares) in enumerate(by_title.items(), 1):
            axes = figure.add_subplot(1, len(by_title), place)
            axes.set(title=title, xlabel=columns, ylabel=rows if place == 1 else "")
            mesh = _fill(axes, shares, classes, letters, with_rows=place == 1)
        bar = figure.colorbar(mesh, ax=axes, shrink=0.6, aspect=25, pad=0.02, label="share")
        bar.outline.set_visible(False)

    return drawn(draw, (width, fitting * side + 1.6), form)


def _fill(
    axes: Axes, shares: FloatArray, classes: Sequence[str], letters: float, *, with_rows: bool
) -> QuadMesh:
    count = len(classes)
    names = [shown(name) for name in classes]
    # squares of their own stay sharp in an SVG, and white edges part them
    mesh = axes.pcolormesh(
        shares, cmap="Blues", vmin=0.0, vmax=1.0, edgecolors="white", linewidth=1.0
    )
    middles = np.arange(count) + 0.5
    axes.set_xticks(middles, names, rotation=60, ha="right", rotation_mode="anchor")
    axes.set_yticks(middles, names if with_rows else [""] * count)
    axes.set_aspect("equal")
    axes.invert_yaxis()
    axes.grid(visible=False)
    axes.tick_params(length=0, labelsize=letters)
    axes.spines[:].set_visible(False)
    if count <= MAX_NUMBERED:
        _number(axes, shares, size=min(letters, 8.0 if count <= MAX_FULL_SIZE else 5.0))
    return mesh


def _number(axes: Axes, shares: FloatArray, size: float) -> None:
    """Per cent in every cell that rounds to one at least."""
    for (row, column), share in np.ndenumerate(shares):
        if share >= 0.005:
            ink = "white" if share > DARK else "#222222"
            middle = (column + 0.5, row + 0.5)
            axes.text(*middle, f"{100 * share:.0f}", ha="center", va="center", size=size, color=ink)
