"""A clip as a small picture with a few stick figures over time.

The x axis of the picture is the horizontal direction in which the joints move most relative to the
hips: a walk is seen from the side, a waving person from the front. The poses are those that differ
most from each other, in the order of time, so that a kick shows the kick. The SVG has no scripts
and no external references, so it is safe to embed.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray
from app.services.figures.stick_figure import (
    GROUND,
    LEFT,
    PAPER,
    RIGHT,
    TRUNK,
    text,
    widest_direction,
)

WIDTH, HEIGHT = 320, 180
MARGIN = 12.0
"""Free pixels on each side."""
POSES = 5
"""Figures in a picture; fewer if the clip has fewer frames."""

_R = JointRole
_LIMBS: tuple[tuple[str, tuple[JointRole, ...]], ...] = (
    ("far", (_R.HIPS, _R.LEFT_KNEE, _R.LEFT_FOOT)),
    ("far", (_R.NECK, _R.LEFT_SHOULDER, _R.LEFT_ELBOW, _R.LEFT_HAND)),
    ("trunk", (_R.HIPS, _R.NECK, _R.HEAD)),
    ("near", (_R.HIPS, _R.RIGHT_KNEE, _R.RIGHT_FOOT)),
    ("near", (_R.NECK, _R.RIGHT_SHOULDER, _R.RIGHT_ELBOW, _R.RIGHT_HAND)),
)
_COLORS = {"far": LEFT, "trunk": TRUNK, "near": RIGHT}
_COLUMN = {role: index for index, role in enumerate(SUN_ROLES)}


def thumbnail(positions: FloatArray, title: str) -> str:
    """An SVG of 320 x 180 pixels from positions (frames, 13, 3), meters, Y up, in SUN_ROLES order.

    Time runs from left to right and from pale to full color; the left limbs are orange,
    the right ones blue.
    """
    chosen = _spread(positions)
    hips = positions[:, _COLUMN[_R.HIPS]]
    flat = _project(chosen, widest_direction(_around_hips(positions), hips[-1] - hips[0]))
    figure_points, head, ground = _side_by_side(flat)
    figures = "".join(
        _figure(points, head, opacity)
        for points, opacity in zip(figure_points, _opacities(len(figure_points)), strict=True)
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
        f'width="{WIDTH}" height="{HEIGHT}" role="img">'
        f"<title>{text(title)}</title>"
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="{PAPER}"/>'
        f'<path d="M0 {ground:.1f}H{WIDTH}" stroke="{GROUND}" stroke-width="1.5"/>'
        f'<g fill="none" stroke-width="3" stroke-linecap="round" stroke-linejoin="round">'
        f"{figures}</g></svg>"
    )


def _spread(positions: FloatArray) -> FloatArray:
    """(poses, 13, 3) in the order of time: at most POSES poses that differ most.

    The first is the first frame. Each next one is the frame farthest from the chosen ones.
    """
    relative = _around_hips(positions).reshape(len(positions), -1)
    chosen = [0]
    nearest = np.linalg.norm(relative - relative[0], axis=1)
    while len(chosen) < min(POSES, len(positions)):
        chosen.append(int(np.argmax(nearest)))
        nearest = np.minimum(nearest, np.linalg.norm(relative - relative[chosen[-1]], axis=1))
    return np.asarray(positions[sorted(chosen)], dtype=np.float64)


def _around_hips(positions: FloatArray) -> FloatArray:
    """(frames, 13, 3) meters relative to the hips."""
    hips = positions[:, [_COLUMN[_R.HIPS]], :]
    return np.asarray(positions - hips, dtype=np.float64)


def _project(poses: FloatArray, direction: FloatArray) -> FloatArray:
    """(poses, 13, 2) meters: along `direction` relative to the hips, and height above the floor."""
    across = _around_hips(poses)[:, :, [0, 2]] @ direction
    height = poses[:, :, 1] - poses[:, :, 1].min()
    return np.stack([across, height], axis=-1)


def _side_by_side(flat: FloatArray) -> tuple[FloatArray, float, float]:
    """Points (poses, 13, 2), radius of the head and y of the floor, all in pixels.

    flat: (poses, 13, 2) meters. The figures have one scale and equal gaps between them.
    """
    lefts, rights = flat[:, :, 0].min(axis=1), flat[:, :, 0].max(axis=1)
    head_size = 0.12 * max(float(flat[:, :, 1].max()), 1e-3)
    min_width = float((rights - lefts).sum()) + head_size * (len(flat) + 1)
    height = float(flat[:, :, 1].max()) + head_size
    scale = min((WIDTH - 2 * MARGIN) / max(min_width, 1e-3), (HEIGHT - 2 * MARGIN) / height)
    gap = (WIDTH - 2 * MARGIN - scale * float((rights - lefts).sum())) / (len(flat) + 1)
    starts = MARGIN + gap + np.concatenate([[0.0], np.cumsum(scale * (rights - lefts) + gap)[:-1]])
    # a third of the free height goes below the floor
    ground = HEIGHT - MARGIN - (HEIGHT - 2 * MARGIN - scale * height) / 3
    x = starts[:, None] + scale * (flat[:, :, 0] - lefts[:, None])
    y = ground - scale * flat[:, :, 1]
    return np.stack([x, y], axis=-1), 0.5 * scale * head_size, ground


def _figure(points: FloatArray, head: float, opacity: float) -> str:
    """One figure from its 13 points (13, 2) in pixels."""
    limbs = "".join(
        f'<path d="{_line(points, roles)}" stroke="{_COLORS[side]}"/>' for side, roles in _LIMBS
    )
    x, y = points[_COLUMN[_R.HEAD]]
    circle = f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{head:.1f}" fill="{_COLORS["trunk"]}"/>'
    return f'<g opacity="{opacity:.2f}">{limbs}{circle}</g>'


def _line(points: FloatArray, roles: tuple[JointRole, ...]) -> str:
    return "M" + "L".join(f"{points[_COLUMN[r]][0]:.1f} {points[_COLUMN[r]][1]:.1f}" for r in roles)


def _opacities(count: int) -> Iterator[float]:
    return (0.4 + 0.6 * (i + 1) / count for i in range(count))
