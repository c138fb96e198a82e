"""Single poses in the body frame: without position, heading and size.

A query by pose has no motion around it. So each pose is treated as a motion of one frame, with its
own hips, heading and body length (see `body_frame`). Equal poses then have equal numbers.
"""

from __future__ import annotations

import numpy as np

from app.motion.frame.body_frame import (
    MIN_AXIS_SHARE,
    MIN_BODY_SIZE,
    NECK_TO_HEAD_PER_TORSO,
    SHIN_PER_TORSO,
)
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray

_R = JointRole
_HIPS = SUN_ROLES.index(_R.HIPS)
SIDES = ((_R.LEFT_SHOULDER, _R.RIGHT_SHOULDER), (_R.LEFT_KNEE, _R.RIGHT_KNEE))
"""Pairs of joints that show left and right, the better one first."""

_LENGTHS = (
    (_R.NECK, _R.HIPS),
    (_R.HEAD, _R.NECK),
    (_R.LEFT_FOOT, _R.LEFT_KNEE),
    (_R.RIGHT_FOOT, _R.RIGHT_KNEE),
)
_TIPS, _STARTS = ([SUN_ROLES.index(pair[end]) for pair in (*_LENGTHS, *SIDES)] for end in (0, 1))


def body_poses(positions: FloatArray) -> FloatArray:
    """(n, 13, 3) float64 poses in the body frame, in body lengths.

    positions: (n, 13, 3) in SUN_ROLES order, any unit, Y up. A joint at the position of its
    neighbor toward the trunk counts as missing (see `Motion.role_positions`). The heading is that
    of the shoulders if their line is level enough, else that of the more level one of shoulders and
    knees. A pose without size, or without left and right, is NaN.
    """
    # (3, 13, n): planes of x, y and z, in which everything below is contiguous
    planes = np.array(np.asarray(positions).T, dtype=np.float64, order="C")
    lines = planes[:, _TIPS] - planes[:, _STARTS]
    lengths = np.sqrt(np.square(lines).sum(axis=0))
    size = _body_lengths(lengths[: len(_LENGTHS)])
    across, along, width = _left_lines(lines[:, len(_LENGTHS) :], lengths[len(_LENGTHS) :])
    size[(size <= MIN_BODY_SIZE) | (width <= MIN_BODY_SIZE)] = np.nan
    planes -= planes[:, _HIPS, None]
    planes /= size
    x, y, z = planes
    return np.stack([across * x + along * z, y, across * z - along * x]).T


def _body_lengths(lengths: FloatArray) -> FloatArray:
    """(n,) the body lengths; lengths: (4, n) of torso, neck to head, and both shins."""
    torso, head, *shins = lengths
    # A missing foot is at the position of the knee, so its shin has the length 0.
    shin_count = np.count_nonzero(shins, axis=0)
    head = np.where(head > 0, head, NECK_TO_HEAD_PER_TORSO * torso)
    shin = np.where(shin_count > 0, sum(shins) / np.maximum(shin_count, 1), SHIN_PER_TORSO * torso)
    return np.asarray(torso + head + shin)


def _left_lines(
    lines: FloatArray, lengths: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """X (n,) and Z (n,) of the horizontal unit vector to the left, and the line's width (n,).

    lines: (3, 2, n) the lines of the SIDES from right to left. lengths: (2, n) of these lines.
    """
    widths = np.hypot(lines[0], lines[2])
    shares = widths / np.maximum(lengths, MIN_BODY_SIZE)
    second = (shares[0] <= MIN_AXIS_SHARE) & (shares[1] > shares[0])
    x, _, z = np.where(second, lines[:, 1], lines[:, 0])
    width = np.where(second, widths[1], widths[0])
    divisor = np.maximum(width, MIN_BODY_SIZE)
    return x / divisor, z / divisor, width
