"""The energy of a motion: how fast the joints move (Perera 2009, section 3.1).

Global energy uses the joints' velocities in the world, local energy those in the body frame. Both
are in body lengths per second, so thresholds do not depend on the body's size. All joints have the
same weight, or they are weighted by the mass that moves with them (section 3.4, fig. 6).

Differentiation amplifies the noise of markers. So positions are smoothed first; the RMS method
smooths noisy positions more. The energy that the remaining noise is expected to add is subtracted.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import scipy

from app.analysis.energy.marker_noise import noise_of_speed, noise_power
from app.motion.canonical.center_of_mass import ROLE_MASSES
from app.motion.frame.body_frame import BodyTrack
from app.numerics.arrays import FloatArray
from app.numerics.differences import central_differences, point_reflected
from app.numerics.quantiles import quantile

MIN_SMOOTHING = 1 / 30
"""Seconds (standard deviation): the weakest smoothing."""

MAX_SMOOTHING = 3 / 30
"""Seconds: the strongest smoothing. More would merge neighboring minima of a dance."""

MAX_NOISE_SHARE = 0.05
"""Smoothing grows until the noise adds at most this share of the high energies."""

MIN_ENERGY_TO_NOISE = 0.1
"""The smallest energy, as a share of the noise. Smaller values of a noisy motion mean nothing."""

HIGH_QUANTILE = 0.9
"""The quantile of an energy over time that counts as high."""


class EnergyMethod(StrEnum):
    """How the velocities of all joints become one number."""

    RMS = "rms"
    """The root mean square of the joints' speeds. Limbs that move in opposite directions add up."""

    PRINTED = "printed"
    """Equations 1 and 2 as printed: the length of the weighted sum of the velocities."""


class Weights(StrEnum):
    """How the joints are weighted. The weights sum to 1."""

    UNIFORM = "uniform"
    """All joints have the same weight, so the ends of the limbs count much (as in the paper)."""

    MASS = "mass"
    """By the mass that moves with each joint. PRINTED then gives the center of mass's speed."""


@dataclass(frozen=True, slots=True)
class EnergyCurve:
    """An energy over time.

    values: (n,) body lengths per second. noise: the energy of noise alone, which was subtracted
    (its square, from the square). smoothing: seconds (standard deviation) of the smoothing.
    """

    values: FloatArray
    noise: float
    smoothing: float


@dataclass(frozen=True, slots=True)
class Energies:
    """The energies of a motion: in the world (F^G of the paper) and in the body frame (F^L)."""

    global_curve: EnergyCurve
    local_curve: EnergyCurve

    @property
    def global_energy(self) -> FloatArray:
        """(n,) body lengths per second, in the world."""
        return self.global_curve.values

    @property
    def local_energy(self) -> FloatArray:
        """(n,) body lengths per second, in the body frame."""
        return self.local_curve.values


def energies(
    track: BodyTrack,
    method: EnergyMethod = EnergyMethod.RMS,
    weights: Weights = Weights.UNIFORM,
) -> Energies:
    """The global and the local energy of each frame of `track`.

    method: how velocities become one number. weights: of the joints.
    """
    # relative to the first frame, so that rounding does not depend on the position in the world
    world = (track.positions - track.origin[:1, None]) / track.body_length
    shares = _shares(weights, world.shape[1])
    curve = _printed if method is EnergyMethod.PRINTED else _rms
    return Energies(*(curve(seen, track.rate, shares) for seen in (world, track.local)))


def _shares(weights: Weights, joints: int) -> FloatArray:
    return ROLE_MASSES if weights is Weights.MASS else np.full(joints, 1 / joints)


def _printed(positions: FloatArray, rate: float, shares: FloatArray) -> EnergyCurve:
    sums = np.einsum("j,njx->nx", shares, velocities(positions, rate, MIN_SMOOTHING))
    return EnergyCurve(np.linalg.norm(sums, axis=-1), 0.0, MIN_SMOOTHING)


def _rms(positions: FloatArray, rate: float, shares: FloatArray) -> EnergyCurve:
    noise = noise_power(positions, shares)
    light_curve = _above_noise(positions, rate, shares, noise, MIN_SMOOTHING)
    smoothing = _smoothing(light_curve)
    if smoothing == MIN_SMOOTHING:
        return light_curve
    return _above_noise(positions, rate, shares, noise, smoothing)


def _smoothing(light_curve: EnergyCurve) -> float:
    """The seconds of smoothing that the noise requires; light_curve: with the weakest."""
    high = float(quantile(light_curve.values, HIGH_QUANTILE))
    if not light_curve.noise > MAX_NOISE_SHARE * high:
        return MIN_SMOOTHING
    # The noise of a speed falls with the power -3/2 of the smoothing.
    factor = (light_curve.noise / (MAX_NOISE_SHARE * high)) ** (2 / 3) if high > 0 else np.inf
    return float(min(MIN_SMOOTHING * factor, MAX_SMOOTHING))


def _above_noise(
    positions: FloatArray, rate: float, shares: FloatArray, noise: float, smoothing: float
) -> EnergyCurve:
    # (n,) the weighted mean of squared speeds; squared noise adds to squared speeds
    squares = np.square(velocities(positions, rate, smoothing)).sum(axis=-1) @ shares
    added = noise * noise_of_speed(smoothing * rate) * rate**2
    values = np.sqrt(np.maximum(squares - added, MIN_ENERGY_TO_NOISE**2 * added))
    return EnergyCurve(values, float(np.sqrt(added)), smoothing)


def velocities(positions: FloatArray, rate: float, smoothing: float) -> FloatArray:
    """(n, joints, 3) the velocities, per second, of smoothed `positions` (n, joints, 3).

    rate: Hz. smoothing: seconds, the standard deviation of the Gaussian.
    """
    return central_differences(_smoothed(positions, smoothing * rate)) * rate


def _smoothed(positions: FloatArray, spread: float) -> FloatArray:
    """`positions` (n, joints, 3) smoothed by a Gaussian of `spread` frames.

    Both ends are continued by point reflection, so that they keep their speed.
    """
    reach = int(np.ceil(4 * spread))
    continued = point_reflected(positions, reach)
    return np.asarray(scipy.ndimage.gaussian_filter1d(continued, spread, axis=0)[reach:-reach])
