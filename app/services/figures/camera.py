"""The camera of an animated figure: direction, scale, and whether it follows the body."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.numerics.arrays import FloatArray, IntArray
from app.services.figures.stick_figure import widest_direction

WIDTH, HEIGHT = 360, 300
"""Pixels of the panel of one figure."""
MARGIN = 16.0
CAPTION = 22.0
"""Pixels kept free above figures that have labels."""
MIN_FIXED_SHARE = 0.6
"""If a fixed camera would reduce the figure below this share of its size, the camera follows."""
HEAD_SIZE = 0.06
"""Radius of a head as a share of the height of the visible body."""
_MIN_EXTENT = 1e-3
"""Meters. A smaller body counts as this large, so that no scale is infinite."""


@dataclass(frozen=True, slots=True)
class Figure:
    """One body.

    positions: (frames, joints, 3) meters, Y up; parents: (joints,), -1 for a root; names: of
    joints, for the colors of limbs and the head; label: text above the figure.
    """

    positions: FloatArray
    parents: IntArray
    names: Sequence[str] = ()
    label: str = ""

    @property
    def root(self) -> FloatArray:
        """(frames, 3) positions of the first root."""
        first = int(np.flatnonzero(np.asarray(self.parents) < 0)[0])
        return np.asarray(self.positions[:, first])


@dataclass(frozen=True, slots=True)
class Camera:
    """The projection of bodies to a panel, seen from the side.

    direction: (2,) horizontal unit vector (x, z), the picture's x axis; scale: pixels per meter;
    center: meters along `direction` in the middle of the panel; floor: height of the floor in
    meters; ground: y of the floor in pixels; head: radius in pixels; follows: whether the camera
    moves with the root.
    """

    direction: FloatArray
    scale: float
    center: float
    floor: float
    ground: float
    head: float
    follows: bool

    def travel(self, figure: Figure) -> FloatArray:
        """(frames,) position of the camera along `direction` in meters; 0 for a fixed camera."""
        root = figure.root[:, [0, 2]] @ self.direction
        return np.asarray(root if self.follows else np.zeros(len(root)))

    def pixels(self, figure: Figure) -> FloatArray:
        """(frames, joints, 2) x and y in pixels in the figure's panel."""
        across = figure.positions[..., [0, 2]] @ self.direction - self.travel(figure)[:, None]
        x = 0.5 * WIDTH + self.scale * (across - self.center)
        # The y axis of SVG points down.
        y = self.ground - self.scale * (figure.positions[..., 1] - self.floor)
        return np.stack([x, y], axis=-1)


def camera_for(figures: Sequence[Figure]) -> Camera:
    """A common camera for all figures that keeps each of them inside its panel."""
    # (frames, joints of all figures, 3) relative to each figure's own root
    relative = np.concatenate([f.positions - f.root[:, None] for f in figures], axis=1)
    root = figures[0].root
    direction = widest_direction(relative, root[-1] - root[0])
    heights = np.concatenate([figure.positions[..., 1].ravel() for figure in figures])
    height = max(float(np.ptp(heights)), _MIN_EXTENT) * (1 + HEAD_SIZE)
    caption = CAPTION if any(figure.label for figure in figures) else 0.0
    max_scale = (HEIGHT - 2 * MARGIN - caption) / height
    # The x coordinates that a fixed camera sees, and those that a following camera sees.
    fixed = np.concatenate([(f.positions[..., [0, 2]] @ direction).ravel() for f in figures])
    following = (relative[..., [0, 2]] @ direction).ravel()
    follows = _scale(fixed, height, max_scale) < MIN_FIXED_SHARE * _scale(
        following, height, max_scale
    )
    visible = following if follows else fixed
    scale = _scale(visible, height, max_scale)
    return Camera(
        direction=direction,
        scale=scale,
        center=0.5 * float(visible.min() + visible.max()),
        floor=float(heights.min()),
        # a third of the free height goes below the floor
        ground=HEIGHT - MARGIN - (max_scale - scale) * height / 3,
        head=HEAD_SIZE * scale * height,
        follows=follows,
    )


def _scale(across: FloatArray, height: float, max_scale: float) -> float:
    """Pixels per meter at which x coordinates `across` (m) and a `height` (m) fit in the panel."""
    width = max(float(np.ptp(across)), _MIN_EXTENT) + 2 * HEAD_SIZE * height
    return min(max_scale, (WIDTH - 2 * MARGIN) / width)
