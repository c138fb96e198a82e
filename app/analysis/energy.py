"""How much a body moves, seen from the floor and from the waist (Perera 2009, section 3.1).

Global energy sees the joints' velocities in the world, local energy in the body frame.
Both in body lengths per second, so that thresholds need no unit; all joints weigh alike
(Perera, section 3.4, found little in other weights).
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from scipy.ndimage import gaussian_filter1d

from app.motion.body_frame import BodyTrack
from app.numerics.arrays import FloatArray

SMOOTHING = 1 / 30
"""Seconds (standard deviation): markers shake by millimetres, which speed magnifies."""


class EnergyMethod(StrEnum):
    """How joints' velocities become one number."""

    RMS = "rms"
    """Root mean square of the joints' speeds: limbs that move against each other add up."""

    PRINTED = "printed"
    """Equations 1 and 2 as printed, the length of the velocities' sum (here their mean)."""


@dataclass(frozen=True, slots=True)
class Energies:
    """Energy over time, (n,) each, body lengths per second: F^G and F^L of the paper."""

    global_energy: FloatArray
    local_energy: FloatArray


def energies(track: BodyTrack, method: EnergyMethod = EnergyMethod.RMS) -> Energies:
    """Global and local energy of each frame of `track`."""
    world = (track.positions - track.origin[:1, None]) / track.body_length
    return Energies(_energy(world, track.rate, method), _energy(track.local, track.rate, method))


def _energy(positions: FloatArray, rate: float, method: EnergyMethod) -> FloatArray:
    """(n,) energy of joints at `positions` (n, joints, 3)."""
    velocities = np.asarray(np.gradient(_smoothed(positions, rate), axis=0)) * rate
    if method is EnergyMethod.PRINTED:
        return np.asarray(np.linalg.norm(velocities.mean(axis=1), axis=-1))
    return np.asarray(np.sqrt(np.square(velocities).sum(axis=-1).mean(axis=1)))


def _smoothed(positions: FloatArray, rate: float) -> FloatArray:
    """Smoothed in time; ends are continued by point reflection, so that they keep their speed."""
    spread = SMOOTHING * rate
    reach = int(np.ceil(4 * spread))
    continued = np.pad(
        positions, ((reach, reach), (0, 0), (0, 0)), mode="reflect", reflect_type="odd"
    )
    return np.asarray(gaussian_filter1d(continued, spread, axis=0)[reach:-reach])
