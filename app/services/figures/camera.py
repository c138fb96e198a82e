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
FOLLOW_BELOW = 0.6
"""If a fixed camera would reduce the figure below this share of its size, the camera follows."""
HEAD_SIZE = 0.06
"""Radius of a head as a share of the height of the visible body."""
_SMALLEST = 1e-3


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
    """direction: (2,) horizontal unit vector (x, z), the picture's x axis; scale: pixels a
    meter; center: meters along `direction` in the middle of the panel; floor: meters above 0;
    ground: its y in pixels; head: radius in pixels; follows: whether it goes with the root."""

    direction: FloatArray
    scale: float
    center: float
    floor: float
    ground: float
    head: float
    follows: bool

    def passed(self, figure: Figure) -> FloatArray:
        """(frames,) meters that the camera has moved along `direction`."""
        gone = figure.root[:, [0, 2]] @ self.direction
        return np.asarray(gone if self.follows else np.zeros(len(gone)))

    def pixels(self, figure: Figure) -> FloatArray:
        """(frames, joints, 2) x and y in pixels in the figure's panel."""
        across = figure.positions[..., [0, 2]] @ self.direction - self.passed(figure)[:, None]
        x = 0.5 * WIDTH + self.scale * (across - self.center)
        y = self.ground - self.scale * (figure.positions[..., 1] - self.floor)
        return np.stack([x, y], axis=-1)


def camera_for(figures: Sequence[Figure]) -> Camera:
    """A common camera for all figures that keeps each of them inside its panel."""
    around = np.concatenate([f.positions - f.root[:, None] for f in figures], axis=1)
    root = figures[0].root
    direction = widest_direction(around, root[-1] - root[0])
    heights = np.concatenate([figure.positions[..., 1].ravel() for figure in figures])
    tall = max(float(np.ptp(heights)), _SMALLEST) * (1 + HEAD_SIZE)
    caption = CAPTION if any(figure.label for figure in figures) else 0.0
    most = (HEIGHT - 2 * MARGIN - caption) / tall
    still = np.concatenate([(f.positions[..., [0, 2]] @ direction).ravel() for f in figures])
    along = (around[..., [0, 2]] @ direction).ravel()
    follows = _scale(still, tall, most) < FOLLOW_BELOW * _scale(along, tall, most)
    seen = along if follows else still
    scale = _scale(seen, tall, most)
    return Camera(
        direction=direction,
        scale=scale,
        center=0.5 * float(seen.min() + seen.max()),
        floor=float(heights.min()),
        ground=HEIGHT - MARGIN - (most - scale) * tall / 3,
        head=HEAD_SIZE * scale * tall,
        follows=follows,
    )


def _scale(across: FloatArray, tall: float, most: float) -> float:
    """Pixels per meter at which a body of extent `across` (m) and height `tall` (m) fits."""
    wide = max(float(np.ptp(across)), _SMALLEST) + 2 * HEAD_SIZE * tall
    return min(most, (WIDTH - 2 * MARGIN) / wide)
