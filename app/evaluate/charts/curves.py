"""Curves as a picture with one or more panels; colors and dashes distinguish groups."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from app.evaluate.charts.drawing import Format, add_legend, color, dashes, rendered, shown
from app.numerics.arrays import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

PANEL = (4.6, 3.4)
"""Width and height of a panel, in inches."""
MAX_BOLD_CURVES = 8
"""If a group has more curves in a panel, they are thin and transparent."""


@dataclass(frozen=True, slots=True)
class Curve:
    """One line: `x` (n,) and `y` (n,); curves of one `group` have the same style and name."""

    x: FloatArray
    y: FloatArray
    group: str = ""


@dataclass(frozen=True, slots=True)
class Panel:
    """Axes with curves.

    ticks: names for x = 0, 1, 2...; log_y: a logarithmic y axis; y_range: its limits;
    marked: x positions of dashed lines.
    """

    curves: Sequence[Curve]
    title: str = ""
    x_label: str = ""
    y_label: str = ""
    ticks: Sequence[str] = ()
    log_y: bool = False
    y_range: tuple[float, float] | None = None
    marked: Sequence[float] = ()


def curves_picture(
    panels: Sequence[Panel], form: Format, *, title: str = "", columns: int = 2
) -> bytes:
    """Draw panels row by row, `columns` in a row; a group has the same style in all panels.

    Raises ValueError without a panel.
    """
    if not panels:
        raise ValueError("a picture needs a panel")
    groups = list(dict.fromkeys(curve.group for panel in panels for curve in panel.curves))
    across = min(columns, len(panels))
    down = -(-len(panels) // across)

    def draw(figure: Figure) -> None:
        figure.suptitle(title)
        handles: dict[str, Line2D] = {}
        for position, panel in enumerate(panels, 1):
            handles |= _draw(figure.add_subplot(down, across, position), panel, groups)
        add_legend(figure, list(handles.values()), list(handles))

    legend = 1.8 if any(groups) else 0.0
    return rendered(draw, (PANEL[0] * across + legend, PANEL[1] * down + 0.3), form)


def _draw(axes: Axes, panel: Panel, groups: Sequence[str]) -> dict[str, Line2D]:
    """Fill one panel; returns a line of each of its groups, for the legend."""
    axes.set(title=panel.title, xlabel=panel.x_label, ylabel=panel.y_label)
    if panel.log_y:
        axes.set_yscale("log")
        # matplotlib's own powers of ten are formulas, which are switched off (see `drawing._STYLE`)
        axes.yaxis.set_major_formatter("{x:.0e}")
    if panel.y_range:
        axes.set_ylim(*panel.y_range)
    if panel.ticks:
        names = [shown(name) for name in panel.ticks]
        axes.set_xticks(range(len(names)), names, rotation=60, ha="right", rotation_mode="anchor")
    for x in panel.marked:
        axes.axvline(x, color="#888888", linestyle=":", linewidth=0.9, zorder=1)
    members = [curve.group for curve in panel.curves]
    handles: dict[str, Line2D] = {}
    for curve in panel.curves:
        number, crowded = groups.index(curve.group), members.count(curve.group) > MAX_BOLD_CURVES
        (line,) = axes.plot(
            curve.x,
            curve.y,
            color=color(number),
            linestyle=dashes(number),
            linewidth=0.7 if crowded else 1.4,
            alpha=0.55 if crowded else 1.0,
        )
        handles.setdefault(curve.group, line)
    return handles
