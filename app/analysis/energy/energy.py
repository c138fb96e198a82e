"""How much a body moves, seen from the floor and from the waist (Perera 2009, section 3.1).

Global energy sees the joints' velocities in the world, local energy in the body frame.
Both in body lengths per second, so that thresholds need no unit. Joints weigh alike, or by
the mass that moves with them (section 3.4, fig. 6).

Speed magnifies the shaking of markers: positions are smoothed first, and for the RMS the
more the more they shake; what noise is still expected to add is taken off.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import scipy

from app.analysis.energy.marker_noise import noise_of_speed, noise_power
from app.motion.canonical.centre_of_mass import ROLE_MASSES
from app.motion.frame.body_frame import BodyTrack
from app.numerics.arrays import FloatArray

SMOOTHING = 1 / 30
"""Seconds (standard deviation), at least."""

MAX_SMOOTHING = 3 / 30
"""Seconds; more would smear one rest into the next at dancing tempi."""

NOISE_SHARE = 0.05
"""Of the high energies: noise is smoothed until it adds no more than that, where it can be."""

UNSURE = 0.1
"""Share of the noise below which nothing is told: rest is never quite 0 in what shakes."""

HIGH = 0.9
"""Quantile over time of an energy that counts as high."""


class EnergyMethod(StrEnum):
    """How joints' velocities become one number."""

    RMS = "rms"
    """Root mean square of the joints' speeds: limbs that move against each other add up."""

    PRINTED = "printed"
    """Equations 1 and 2 as printed, the length of the weighted sum of the velocities."""


class Weights(StrEnum):
    """How joints are weighted; weights sum to 1."""

    UNIFORM = "uniform"
    """All alike, which gives the ends of the limbs a clear voice; the paper's choice."""

    MASS = "mass"
    """By the mass that moves with each joint; the global sum is then the center of mass's."""


@dataclass(frozen=True, slots=True)
class EnergyCurve:
    """values: (n,) body lengths per second; noise: what noise alone had added to rest, taken
    off; smoothing: seconds (standard deviation) by which positions were smoothed."""

    values: FloatArray
    noise: float
    smoothing: float


@dataclass(frozen=True, slots=True)
class Energies:
    """Energy over time as seen from the floor and from the waist: F^G and F^L of the paper."""

    whole: EnergyCurve
    own: EnergyCurve

    @property
    def global_energy(self) -> FloatArray:
        """(n,) body lengths per second, in the world."""
        return self.whole.values

    @property
    def local_energy(self) -> FloatArray:
        """(n,) body lengths per second, in the body frame."""
        return self.own.values


def energies(
    track: BodyTrack,
    method: EnergyMethod = EnergyMethod.RMS,
    weights: Weights = Weights.UNIFORM,
) -> Energies:
    """Global and local energy of each frame of `track`."""
    world = (track.positions - track.origin[:1, None]) / track.body_length
    shares = _shares(weights, world.shape[1])
    curve = _printed if method is EnergyMethod.PRINTED else _rms
    return Energies(*(curve(seen, track.rate, shares) for seen in (world, track.local)))


def _shares(weights: Weights, joints: int) -> FloatArray:
    return ROLE_MASSES if weights is Weights.MASS else np.full(joints, 1 / joints)


def _printed(positions: FloatArray, rate: float, shares: FloatArray) -> EnergyCurve:
    sums = np.einsum("j,njx->nx", shares, velocities(positions, rate, SMOOTHING))
    return EnergyCurve(np.linalg.norm(sums, axis=-1), 0.0, SMOOTHING)


def _rms(positions: FloatArray, rate: float, shares: FloatArray) -> EnergyCurve:
    noise = noise_power(positions, shares)
    lightly = _above_noise(positions, rate, shares, noise, SMOOTHING)
    smoothing = _smoothing(lightly)
    if smoothing == SMOOTHING:
        return lightly
    return _above_noise(positions, rate, shares, noise, smoothing)


def _smoothing(lightly: EnergyCurve) -> float:
    """Seconds of smoothing that the noise asks for, from the curve under the least."""
    high = float(np.quantile(lightly.values, HIGH))
    if not lightly.noise > NOISE_SHARE * high:
        return SMOOTHING
    # Noise in speed falls with the power -3/2 of the smoothing.
    wanted = (lightly.noise / (NOISE_SHARE * high)) ** (2 / 3) if high > 0 else np.inf
    return float(min(SMOOTHING * wanted, MAX_SMOOTHING))


def _above_noise(
    positions: FloatArray, rate: float, shares: FloatArray, noise: float, smoothing: float
) -> EnergyCurve:
    squares = np.square(velocities(positions, rate, smoothing)).sum(axis=-1) @ shares
    added = noise * noise_of_speed(smoothing * rate) * rate**2
    values = np.sqrt(np.maximum(squares - added, UNSURE**2 * added))
    return EnergyCurve(values, float(np.sqrt(added)), smoothing)


def velocities(positions: FloatArray, rate: float, smoothing: float) -> FloatArray:
    """Of joints at `positions` (n, joints, 3), smoothed by `smoothing` s before; per second."""
    return np.asarray(np.gradient(_smoothed(positions, smoothing * rate), axis=0)) * rate


def _smoothed(positions: FloatArray, spread: float) -> FloatArray:
    """Smoothed in time; ends are continued by point reflection, so that they keep their speed."""
    reach = int(np.ceil(4 * spread))
    continued = np.pad(
        positions, ((reach, reach), (0, 0), (0, 0)), mode="reflect", reflect_type="odd"
    )
    return np.asarray(scipy.ndimage.gaussian_filter1d(continued, spread, axis=0)[reach:-reach])
