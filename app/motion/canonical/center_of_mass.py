"""The body's center of mass from Sun's 13 roles.

Source: Dempster (1955), as in table 4.1 of Winter, "Biomechanics and motor control of human
movement". The table gives each segment's share of the mass, and the position of its center along
the segment. Feet and hands are points at ankle and wrist.
"""

from __future__ import annotations

import numpy as np

from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray

_R = JointRole
_SEGMENTS: tuple[tuple[JointRole, JointRole, float, float], ...] = (
    (_R.HIPS, _R.NECK, 0.497, 0.5),
    (_R.HEAD, _R.HEAD, 0.081, 0.0),
    (_R.HIPS, _R.LEFT_KNEE, 0.100, 0.433),
    (_R.HIPS, _R.RIGHT_KNEE, 0.100, 0.433),
    (_R.LEFT_KNEE, _R.LEFT_FOOT, 0.0465, 0.433),
    (_R.RIGHT_KNEE, _R.RIGHT_FOOT, 0.0465, 0.433),
    (_R.LEFT_FOOT, _R.LEFT_FOOT, 0.0145, 0.0),
    (_R.RIGHT_FOOT, _R.RIGHT_FOOT, 0.0145, 0.0),
    (_R.LEFT_SHOULDER, _R.LEFT_ELBOW, 0.028, 0.436),
    (_R.RIGHT_SHOULDER, _R.RIGHT_ELBOW, 0.028, 0.436),
    (_R.LEFT_ELBOW, _R.LEFT_HAND, 0.016, 0.43),
    (_R.RIGHT_ELBOW, _R.RIGHT_HAND, 0.016, 0.43),
    (_R.LEFT_HAND, _R.LEFT_HAND, 0.006, 0.0),
    (_R.RIGHT_HAND, _R.RIGHT_HAND, 0.006, 0.0),
)
"""Start, end, share of the body's mass, and position of the center along the segment (0..1)."""


def _weights() -> FloatArray:
    weights = np.zeros(len(SUN_ROLES))
    for start, end, mass, along in _SEGMENTS:
        weights[SUN_ROLES.index(start)] += mass * (1 - along)
        weights[SUN_ROLES.index(end)] += mass * along
    return np.asarray(weights / weights.sum())


ROLE_MASSES = _weights()
"""(13,) the share of the body's mass that belongs to each of SUN_ROLES; the sum is 1."""


def center_of_mass(role_positions: FloatArray) -> FloatArray:
    """(frames, 3) the center of mass of role positions (frames, 13, 3), in their unit.

    role_positions: in SUN_ROLES order.
    """
    positions = np.asarray(role_positions, dtype=np.float64)
    return np.asarray(np.einsum("r,frc->fc", ROLE_MASSES, positions))
