"""Draws points and paths in two or three dimensions. Color and marker show the group."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from app.evaluate.charts.drawing import Format, add_legend, color, dashes, marker, rendered, shown
from app.numerics.arrays import FloatArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, slots=True)
class Cloud:
    """Points of one group: (n, 2) or (n, 3).

    joined: draw a path from point to point instead of markers; labels: a text at each point.
    Clouds of one `group` have the same style and name.
    """

    points: FloatArray
    group: str = ""
    joined: bool = False
    labels: Sequence[str] = ()


def scatter_picture(
    clouds: Sequence[Cloud],
    form: Format,
    *,
    title: str = "",
    axes: Sequence[str] = (),
    equal: bool = True,
) -> bytes:
    """Draw all clouds in one frame with the two or three dimensions of the points.

    axes: names of the dimensions; equal: whether one unit has the same length on every axis.
    Raises ValueError without a cloud, or when the dimensions are not two or three for all.
    """
    dimensions = {cloud.points.shape[-1] for cloud in clouds if cloud.points.ndim == 2}
    if len(dimensions) != 1 or not dimensions <= {2, 3} or any(c.points.ndim != 2 for c in clouds):
        raise ValueError("all clouds must be (n, 2), or all (n, 3)")
    (dimension,) = dimensions

    def draw(figure: Figure) -> None:
        frame = figure.add_subplot(projection="3d" if dimension == 3 else None)
        frame.set_title(title)
        for set_name, name in zip(
            (frame.set_xlabel, frame.set_ylabel, getattr(frame, "set_zlabel", None)),
            axes,
            strict=False,
        ):
            if set_name is not None:
                set_name(name)
        _fill(figure, frame, clouds)
        if dimension == 3:
            frame.locator_params(nbins=5)
        if equal:
            frame.set_aspect("equal", adjustable="datalim" if dimension == 2 else "box")

    return rendered(draw, (7.4, 5.4), form)


def _fill(figure: Figure, frame: Any, clouds: Sequence[Cloud]) -> None:
    groups = list(dict.fromkeys(cloud.group for cloud in clouds))
    handles: dict[str, Any] = {}
    # by default points farther away fade, and their colors become hard to distinguish
    flat = {"depthshade": False} if clouds[0].points.shape[1] == 3 else {}
    for cloud in clouds:
        number = groups.index(cloud.group)
        columns = cloud.points.T
        if cloud.joined:
            (handle,) = frame.plot(
                *columns, color=color(number), linestyle=dashes(number), linewidth=1.2
            )
        else:
            handle = frame.scatter(
                *columns,
                **flat,
                color=color(number),
                marker=marker(number),
                s=26,
                alpha=0.85,
                edgecolors="white",
                linewidths=0.4,
            )
        handles.setdefault(cloud.group, handle)
        for point, label in zip(cloud.points, cloud.labels, strict=False):
            frame.text(*point, f" {shown(label)}", size=7, color="#333333")
    add_legend(figure, list(handles.values()), list(handles))
