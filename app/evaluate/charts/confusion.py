"""A confusion matrix as a picture (Sun 2011, figure 8)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from app.evaluate.charts.drawing import MAX_INCHES, Format, rendered, shown
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
"""Font size of names in points; it is smaller if a cell is not high enough."""
LETTERS_A_CELL = 0.75 * 72
"""Font size in points per inch of a cell, so that lines of names have space between them."""
DARK = 0.55
"""Cells with a larger share have white numbers."""


def confusion_picture(
    shares: FloatArray,
    classes: Sequence[str],
    form: Format,
    *,
    title: str = "",
    rows: str = "true class",
    columns: str = "taken for",
) -> bytes:
    """Draw `shares` (classes, classes), 0..1, a row for each true class; numbers are percent.

    Raises ValueError if the shapes do not match.
    """
    return confusions_picture({title: shares}, classes, form, rows=rows, columns=columns)


def confusions_picture(
    by_title: Mapping[str, FloatArray],
    classes: Sequence[str],
    form: Format,
    *,
    rows: str = "true class",
    columns: str = "taken for",
    sizes: Sequence[int] = (),
) -> bytes:
    """Draw matrices of the same classes side by side, as in figure 8.

    sizes: the number of clips of each class, for the names of the rows.
    """
    count = len(classes)
    if not count or not by_title or {m.shape for m in by_title.values()} != {(count, count)}:
        raise ValueError("a confusion matrix has one row and one column for each class")
    side = CELL * max(min(count, MAX_FULL_SIZE), 4) + 0.2 * max(count - MAX_FULL_SIZE, 0)
    width, height = (side + 0.3) * len(by_title) + 2.6, side + 1.6
    fitting = min(1.0, MAX_INCHES / width, MAX_INCHES / height)
    letters = min(USUAL_LETTERS, LETTERS_A_CELL * fitting * side / count)

    def draw(figure: Figure) -> None:
        for column, (title, shares) in enumerate(by_title.items(), 1):
            axes = figure.add_subplot(1, len(by_title), column)
            axes.set(title=title, xlabel=columns, ylabel=rows if column == 1 else "")
            mesh = _fill(axes, shares, classes, letters, sizes, with_rows=column == 1)
        bar = figure.colorbar(mesh, ax=axes, shrink=0.6, aspect=25, pad=0.02, label="share")
        bar.outline.set_visible(False)

    return rendered(draw, (width, fitting * side + 1.6), form)


def _fill(
    axes: Axes,
    shares: FloatArray,
    classes: Sequence[str],
    letters: float,
    sizes: Sequence[int],
    *,
    with_rows: bool,
) -> QuadMesh:
    count = len(classes)
    names = [shown(name) for name in classes]
    counted = [f"{name} ({size})" for name, size in zip(names, sizes, strict=False)]
    # separate squares stay sharp in an SVG, with white edges between them
    mesh = axes.pcolormesh(
        shares, cmap="Blues", vmin=0.0, vmax=1.0, edgecolors="white", linewidth=1.0
    )
    middles = np.arange(count) + 0.5
    axes.set_xticks(middles, names, rotation=60, ha="right", rotation_mode="anchor")
    axes.set_yticks(middles, (counted or names) if with_rows else [""] * count)
    axes.set_aspect("equal")
    axes.invert_yaxis()
    axes.grid(visible=False)
    axes.tick_params(length=0, labelsize=letters)
    axes.spines[:].set_visible(False)
    if count <= MAX_NUMBERED:
        _number(axes, shares, size=min(letters, 8.0 if count <= MAX_FULL_SIZE else 5.0))
    return mesh


def _number(axes: Axes, shares: FloatArray, size: float) -> None:
    """Write the percentage into each cell where it rounds to at least one."""
    for (row, column), share in np.ndenumerate(shares):
        if share >= 0.005:
            ink = "white" if share > DARK else "#222222"
            middle = (column + 0.5, row + 0.5)
            axes.text(*middle, f"{100 * share:.0f}", ha="center", va="center", size=size, color=ink)
