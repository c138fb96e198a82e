"""Animated stick figures as SVG with SMIL animation, without a script.

Any page can show the SVG as an image, under any content security policy, and any browser opens it
as a file. A viewer without SMIL shows the first frame. Several figures are side by side, with the
same time, direction and scale, as in Perera 2009, fig. 12.

The direction is the one that shows most of the movement. If the body stays in place, the camera
does not move. Otherwise it follows the body, and marks on the floor, half a meter apart, pass by.
The bar at the bottom shows the time.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from app.motion.skeleton.resampling import resample
from app.numerics.arrays import FloatArray
from app.services.figures.camera import HEIGHT, MARGIN, WIDTH, Camera, Figure, camera_for
from app.services.figures.stick_figure import GROUND, LEFT, PAPER, RIGHT, TRUNK, color, limbs, text

RATE = 15.0
"""Frames per second; browsers interpolate linearly between them."""
MAX_FRAMES = 1200
"""Largest number of frames of a picture; longer motions have fewer frames per second."""
MARK_DISTANCE = 0.5
"""Meters between marks on the floor."""
MAX_MARKS = 400
HEAD = "head"
BAR = 4
"""Height of the time bar in pixels."""


def animated_svg(figures: Sequence[Figure], rate: float, title: str) -> str:
    """An endless animation of figures side by side; all have the same frames, at `rate` Hz.

    Raises ValueError without a figure or a frame.
    """
    if not figures or not all(len(figure.positions) for figure in figures):
        raise ValueError("an animation needs at least one figure, and each figure a frame")
    shown = min(rate, RATE, MAX_FRAMES * rate / len(figures[0].positions))
    moving = [
        replace(f, positions=resample(f.positions.astype(np.float64), rate, shown)) for f in figures
    ]
    camera = camera_for(moving)
    time = _Time((len(moving[0].positions) - 1) / shown)
    width = WIDTH * len(moving)
    panels = "".join(
        f'<svg x="{index * WIDTH}" width="{WIDTH}" height="{HEIGHT}">'
        f"{_panel(figure, camera, time)}</svg>"
        for index, figure in enumerate(moving)
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {HEIGHT}" '
        f'width="{width}" height="{HEIGHT}" role="img"><title>{text(title)}</title>'
        f'<rect width="{width}" height="{HEIGHT}" fill="{PAPER}"/>{panels}'
        f'<rect y="{HEIGHT - BAR}" width="{width}" height="{BAR}" fill="{GROUND}">'
        f"{time.animate('width', ['0', str(width)])}</rect></svg>"
    )


class _Time:
    """Makes animations with the duration of one round."""

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds

    def animate(self, attribute: str, values: Sequence[str]) -> str:
        """Animates an attribute with values at equal intervals; empty if they do not change."""
        timing = self._timing(values)
        return timing and f'<animate attributeName="{attribute}" {timing}/>'

    def move(self, values: Sequence[str]) -> str:
        """Animates a translation with values at equal intervals; empty if they do not change."""
        timing = self._timing(values)
        return timing and f'<animateTransform attributeName="transform" type="translate" {timing}/>'

    def _timing(self, values: Sequence[str]) -> str:
        if self._seconds <= 0 or len(set(values)) < 2:
            return ""
        listed = ";".join(values)
        return f'dur="{self._seconds:.3f}s" repeatCount="indefinite" values="{listed}"'


def _panel(figure: Figure, camera: Camera, time: _Time) -> str:
    points = camera.pixels(figure)
    order = (LEFT, TRUNK, RIGHT)  # the right limbs are drawn last, in front, as seen from the right
    lines = sorted(
        limbs(np.asarray(figure.parents)), key=lambda line: order.index(color(line, figure.names))
    )
    drawn = "".join(_limb(points[:, line], color(line, figure.names), time) for line in lines)
    return (
        f"{_floor(figure, camera, time)}"
        '<g fill="none" stroke-width="5" stroke-linecap="round" stroke-linejoin="round">'
        f"{drawn}</g>{_head(figure, points, camera, time)}{_caption(figure)}"
    )


def _limb(points: FloatArray, stroke: str, time: _Time) -> str:
    """A line through points (frames, joints, 2)."""
    values = [" ".join(f"{x:.1f},{y:.1f}" for x, y in frame) for frame in points]
    moves = time.animate("points", values)
    return f'<polyline points="{values[0]}" stroke="{stroke}">{moves}</polyline>'


def _head(figure: Figure, points: FloatArray, camera: Camera, time: _Time) -> str:
    if HEAD not in figure.names:
        return ""
    x, y = (_numbers(points[:, list(figure.names).index(HEAD), axis]) for axis in (0, 1))
    moves = time.animate("cx", x) + time.animate("cy", y)
    return f'<circle cx="{x[0]}" cy="{y[0]}" r="{camera.head:.1f}" fill="{TRUNK}">{moves}</circle>'


def _floor(figure: Figure, camera: Camera, time: _Time) -> str:
    """The floor with its marks, which pass by if the camera follows the body."""
    travel = camera.travel(figure)
    # The marks cover all of the floor that the camera sees at any time.
    half = 0.5 * WIDTH / camera.scale
    first, last = travel.min() + camera.center - half, travel.max() + camera.center + half
    distance = MARK_DISTANCE
    while (last - first) / distance > MAX_MARKS:
        distance *= 2
    positions = distance * np.arange(np.ceil(first / distance), np.floor(last / distance) + 1)
    marks = "".join(
        f"M{x} {camera.ground:.1f}v6"
        for x in _numbers(0.5 * WIDTH + camera.scale * (positions - camera.center))
    )
    shifts = [f"{x} 0" for x in _numbers(-camera.scale * travel)]
    return (
        f'<g stroke="{GROUND}" stroke-width="2"><path d="M0 {camera.ground:.1f}H{WIDTH}"/>'
        f'<path d="{marks}" transform="translate({shifts[0]})">{time.move(shifts)}</path></g>'
    )


def _caption(figure: Figure) -> str:
    if not figure.label:
        return ""
    return (
        f'<text x="{WIDTH // 2}" y="{MARGIN + 4:.0f}" text-anchor="middle" font-size="15" '
        f'font-family="sans-serif" fill="{TRUNK}">{text(figure.label)}</text>'
    )


def _numbers(values: Iterable[float]) -> list[str]:
    return [f"{value:.1f}" for value in values]
