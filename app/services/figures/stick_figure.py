"""Common parts of pictures of bodies: colors, the best direction of view, and text for XML."""

from __future__ import annotations

from collections.abc import Sequence
from xml.sax.saxutils import escape

import numpy as np

from app.numerics.arrays import FloatArray, IntArray

LEFT, TRUNK, RIGHT = "#c2622d", "#2b3440", "#1f6f8b"
"""Colors of limbs: left ones are orange, right ones blue."""
PAPER, GROUND = "#f6f4ef", "#d5cfc2"

EXTENT_WEIGHT = 0.05
"""Weight of the extent of the body relative to its movement. It decides the direction of view for a
body that does not move."""
MIN_TRAVEL = 0.05
"""Meters along the picture's x axis; a body that moves less far counts as staying in place."""


def widest_direction(relative: FloatArray, travel: FloatArray) -> FloatArray:
    """(2,) horizontal unit vector (x, z) in which a body moves most.

    relative: (frames, joints, 3) meters, Y up, relative to the hips; travel: (3,) meters from the
    first to the last frame. The direction is the first principal axis of the movement, with a small
    weight for the extent of the body. A traveling body moves to the right. If
    the body stays in place, the larger component is positive, so that similar clips have similar
    pictures.
    """
    flat = np.asarray(relative, dtype=np.float64)[:, :, [0, 2]]
    moving = (flat - flat.mean(axis=0)).reshape(-1, 2)
    still = flat.reshape(-1, 2)
    _, vectors = np.linalg.eigh(moving.T @ moving + EXTENT_WEIGHT * (still.T @ still))
    direction: FloatArray = vectors[:, -1]
    sign = float(direction @ travel[[0, 2]])
    if abs(sign) < MIN_TRAVEL:
        sign = float(direction[np.argmax(np.abs(direction))])
    return direction if sign >= 0 else -direction


def limbs(parents: IntArray) -> list[list[int]]:
    """Split a skeleton into lines of joints.

    Each line runs from a root or branching joint to the next branching joint or to an end.

    parents: (joints,) index of each joint's parent, -1 for a root. Returns joint indexes.
    """
    children: dict[int, list[int]] = {}
    for joint, parent in enumerate(parents.tolist()):
        children.setdefault(parent, []).append(joint)
    lines = []
    for start, after in children.items():
        if start < 0 or (len(after) == 1 and parents[start] >= 0):
            continue  # -1 is no joint; a joint with one child is inside a line
        for joint in after:
            line = [start, joint]
            while len(children.get(line[-1], ())) == 1:
                line.append(children[line[-1]][0])
            lines.append(line)
    return lines


def color(line: Sequence[int], names: Sequence[str]) -> str:
    """LEFT or RIGHT if the name of the line's last joint starts so (`left_...`), else TRUNK."""
    name = names[line[-1]] if names else ""
    return LEFT if name.startswith("left_") else RIGHT if name.startswith("right_") else TRUNK


def text(value: str) -> str:
    """The value without unprintable characters, escaped for XML."""
    return escape("".join(c for c in value if c.isprintable()))
