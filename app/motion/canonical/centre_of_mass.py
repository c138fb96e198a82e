"""The body's center of mass from Sun's 13 roles.

Source: Dempster (1955) as tabled by Winter, "Biomechanics and motor control of human
movement", table 4.1: each segment's share of the mass and where along it its own center
lies. Feet and hands are points at ankle and wrist.
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
"""From, to, share of the body's mass, and how far along the segment's center lies."""


def _weights() -> FloatArray:
    weights = np.zeros(len(SUN_ROLES))
    for start, end, mass, along in _SEGMENTS:
        weights[SUN_ROLES.index(start)] += mass * (1 - along)
        weights[SUN_ROLES.index(end)] += mass * along
    return np.asarray(weights / weights.sum())


ROLE_MASSES = _weights()
"""(13,) share of the body's mass that each of SUN_ROLES stands for; the sum is 1."""


def center_of_mass(role_positions: FloatArray) -> FloatArray:
    """(frames, 3) of role positions (frames, 13, 3) in SUN_ROLES order, same unit."""
    positions = np.asarray(role_positions, dtype=np.float64)
    return np.asarray(np.einsum("r,frc->fc", ROLE_MASSES, positions))
