"""Pictures of self-similarity matrices and of motion volumes (Sun 2011, figures 3 and 5) as SVG.

A matrix is a square of 13 x 13 cells, one for each pair of joints: the darker, the farther apart.
The volume is a row of such slices, one behind the other as time goes on. The SVG has no scripts and
no external references, so it is safe to embed.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.motion.roles.joint_roles import SUN_ROLES
from app.numerics.arrays import FloatArray
from app.services.figures.stick_figure import PAPER, text

CELL = 14
"""Pixels of a cell of a matrix."""
NAMES = 92
"""Pixels for the names of the joints."""
LINE = 22
"""Pixels of a line of text."""
STEP, RISE = 98, 9
"""Pixels between two slices of a volume, to the right and upward."""
SHEAR, FLATTENED = 0.35, 0.5
"""How a slice is seen from the side: its width is FLATTENED, its right side higher by SHEAR."""
NEAR, FAR = np.array([247, 251, 255]), np.array([8, 48, 107])
"""The colors (red, green, blue) of the distance 0 and of the largest one."""


def matrix_svg(matrix: FloatArray, largest: float, title: str) -> str:
    """An SVG of a self-similarity matrix (13, 13) with the names of its joints.

    largest: the distance that is drawn darkest.
    """
    side = CELL * len(matrix)
    joints = [role.value.replace("_", " ") for role in SUN_ROLES]
    rows = "".join(
        f'<text x="{NAMES - 6}" y="{LINE + CELL * (row + 0.75):.1f}" text-anchor="end">'
        f"{text(name)}</text>"
        for row, name in enumerate(joints)
    )
    columns = "".join(
        f'<text transform="translate({NAMES + CELL * (column + 0.7):.1f} {LINE + side + 6})'
        f' rotate(-60)" text-anchor="end">{text(name)}</text>'
        for column, name in enumerate(joints)
    )
    body = (
        f'<text x="{NAMES}" y="14" font-size="12">{text(title)}</text>{rows}{columns}'
        f'<g transform="translate({NAMES} {LINE})">{_cells(matrix, largest)}</g>'
    )
    return _svg(NAMES + side + 12, LINE + side + NAMES, title, body)


def volume_svg(slices: FloatArray, times: Sequence[float], largest: float, title: str) -> str:
    """An SVG of some slices (s, 13, 13) of a motion volume; times: (s,) of the slices, seconds."""
    side = CELL * slices.shape[1]
    width, lifted = FLATTENED * side, SHEAR * FLATTENED * side
    top = LINE + lifted + RISE * (len(slices) - 1)
    drawn = []
    # the last slice is the farthest, so it is drawn first
    for number in reversed(range(len(slices))):
        x, y = 8 + STEP * number, top - RISE * number
        drawn.append(
            f'<g transform="matrix({FLATTENED} {-SHEAR * FLATTENED:.3f} 0 1 {x} {y:.1f})">'
            f"{_cells(slices[number], largest)}"
            f'<rect width="{side}" height="{side}" fill="none" stroke="#555"/></g>'
            f'<text x="{x}" y="{y + side + 14:.1f}">{times[number]:.2f} s</text>'
        )
    body = f'<text x="8" y="14" font-size="12">{text(title)}</text>{"".join(drawn)}'
    right = 8 + STEP * (len(slices) - 1) + max(width, 48) + 8
    return _svg(right, top + side + LINE, title, body)


def _cells(matrix: FloatArray, largest: float) -> str:
    """One path for each color: cells of the same color are squares of one path."""
    paths: dict[str, list[str]] = {}
    for (row, column), distance in np.ndenumerate(matrix):
        square = f"M{CELL * column} {CELL * row}h{CELL}v{CELL}h-{CELL}z"
        paths.setdefault(_color(float(distance), largest), []).append(square)
    return "".join(f'<path fill="{color}" d="{"".join(d)}"/>' for color, d in paths.items())


def _color(distance: float, largest: float) -> str:
    share = min(max(distance / largest, 0.0), 1.0) if largest > 0 else 0.0
    # 32 shades are more than the eye tells apart, and make the file smaller
    mixed = NEAR + round(31 * share) / 31 * (FAR - NEAR)
    return "#" + "".join(f"{round(part):02x}" for part in mixed.tolist())


def _svg(width: float, height: float, title: str, body: str) -> str:
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}" '
        f'width="{width:.0f}" height="{height:.0f}" role="img">'
        f"<title>{text(title)}</title>"
        f'<rect width="{width:.0f}" height="{height:.0f}" fill="{PAPER}"/>'
        f'<g font-family="sans-serif" font-size="9" fill="#222">{body}</g></svg>'
    )
