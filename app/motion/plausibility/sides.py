"""Whether left and right of a body agree with the directions of chest, hips, knees and toes.

Left is the cross product of up (along the trunk) and forward. Knees bend forward and toes point
forward, also when somebody walks backward.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from app.motion.motion import Motion
from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.recording import Caution
from app.numerics.arrays import FloatArray

MAX_OPPOSITE = -0.3
"""The largest mean cosine between two directions that count as opposite."""
MIN_LENGTH = 1e-9
"""Meters: a shorter line has no direction."""

_R = JointRole
_Points = Mapping[JointRole, FloatArray]


def side_doubts(motion: Motion, positions: FloatArray) -> Iterator[Caution]:
    """A caution if chest and hips, or the named sides and the feet, are opposite.

    positions: (n, joints, 3) some frames of the motion, in which the sides are measured.
    """
    positions = positions.astype(np.float64)
    sampled = {role: positions[:, joint] for role, joint in motion.roles.items()}
    if _R.NECK not in sampled:
        return
    up = _unit(sampled[_R.NECK] - sampled[_R.HIPS])
    chest, hips = (_left_line(part, sampled, up) for part in ("shoulder", "upper_leg"))
    if hips is None:
        hips = _left_line("knee", sampled, up)
    if hips is None:
        return
    if chest is not None and float(np.einsum("fc,fc->", chest, hips)) < MAX_OPPOSITE * len(hips):
        names = [motion.names[motion.roles[r]] for r in (_R.LEFT_SHOULDER, _R.RIGHT_SHOULDER)]
        detail = (
            f"chest and hips face opposite ways; {names[0]} and {names[1]}, or the legs, may be"
            " exchanged"
        )
        yield Caution("sides_suspect", detail, joint=names[0])
    elif _forward_share(sampled, np.cross(hips, up)) < MAX_OPPOSITE:
        detail = "the knees and feet point backward; left and right may be exchanged"
        yield Caution("sides_suspect", detail)


def _left_line(part: str, sampled: _Points, up: FloatArray) -> FloatArray | None:
    """(frames, 3) the unit vectors to the left at right angles to `up` (frames, 3)."""
    left, right = (_R(f"{side}_{part}") for side in ("left", "right"))
    if left not in sampled or right not in sampled:
        return None
    line = sampled[left] - sampled[right]
    return _unit(line - np.einsum("fc,fc->f", line, up)[:, None] * up)


def _forward_share(sampled: _Points, forward: FloatArray) -> float:
    """The mean cosine of `forward` (frames, 3) and the directions of knees and toes.

    Each direction has its length as its weight: a straight leg shows nothing.
    """
    directions = [
        direction for side in ("left", "right") for direction in _directions(side, sampled)
    ]
    if not directions:
        return 0.0
    lines = np.stack(directions)  # (directions, frames, 3)
    along = float(np.einsum("dfc,fc->", lines, forward))
    possible = float(np.sqrt(np.einsum("dfc,dfc->df", lines, lines)).sum())
    return along / max(possible, MIN_LENGTH)


def _directions(side: str, sampled: _Points) -> Iterator[FloatArray]:
    """(frames, 3) from the leg to the knee, and from the ankle to the toes."""
    knee, foot, toes = (_R(f"{side}_{part}") for part in ("knee", "foot", "toes"))
    if knee not in sampled or foot not in sampled:
        return
    hip = sampled.get(_R(f"{side}_upper_leg"), sampled[_R.HIPS])
    leg, thigh = sampled[foot] - hip, sampled[knee] - hip
    along = np.einsum("fc,fc->f", thigh, leg) / np.maximum(
        np.einsum("fc,fc->f", leg, leg), MIN_LENGTH
    )
    yield thigh - along[:, None] * leg
    if toes in sampled:
        yield sampled[toes] - sampled[foot]


def _unit(vectors: FloatArray) -> FloatArray:
    lengths = np.sqrt(np.einsum("fc,fc->f", vectors, vectors))
    return np.asarray(vectors / np.maximum(lengths, MIN_LENGTH)[:, None])
