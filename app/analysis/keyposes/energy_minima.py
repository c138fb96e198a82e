"""The minima of an energy curve: one between any two clear maxima.

A dancer who holds a pose shakes, breathes and moves a hand. So the energy has many small local
minima in one valley; here a valley is one minimum. Energies are given in units of the curve's
median maximum. So one threshold fits calm and wild dances.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy

from app.analysis.energy.energy import EnergyCurve
from app.numerics.arrays import FloatArray
from app.numerics.quantiles import median, quantile

MIN_PROMINENCE = 0.25
"""Units by which a maximum must rise above the minima on both sides to separate them."""

HIGH_QUANTILE = 0.9
"""The quantile of a curve that is its unit until its median maximum is known."""

MINIMUM_MARGIN = 0.045
"""Units above the least energy that still belong to the minimum."""

NOISE_MARGIN = 0.6
"""The share of the subtracted noise that may still be in the curve."""

END_MARGIN = 0.35
"""Units. If the energy between an end of the clip and a minimum is lower, the minimum reaches to
that end."""

MIN_MAXIMUM = 0.03
"""Body lengths per second. A body whose maxima are lower only breathes and sways."""

CERTAIN_ENERGY = 0.25
"""Units. A minimum with a lower energy certainly is a rest of the body."""

DEFAULT_LENGTH = 4.0
"""Frames: the usual length if no minimum is certain."""


@dataclass(frozen=True, slots=True)
class EnergyMinimum:
    """A minimum of an energy curve; energies are in units of the median maximum.

    lowest: the frame of least energy. first, last: the frames between which the energy stays
    near it. energy: that at `lowest`. drop: from the lower of the two neighboring maxima down to
    `lowest`. at_start, at_end: whether the clip begins or ends at this minimum.
    """

    lowest: int
    first: int
    last: int
    energy: float
    drop: float
    at_start: bool
    at_end: bool

    @property
    def length(self) -> int:
        """The frames from first to last."""
        return self.last - self.first


def find_energy_minima(curve: EnergyCurve) -> tuple[EnergyMinimum, ...]:
    """The minima of an energy curve in order of time; none if the body does not move."""
    values = curve.values
    unit, maxima = median_maximum(values)
    if not len(maxima) or unit < max(MIN_MAXIMUM, curve.noise):
        return ()
    near = max(MINIMUM_MARGIN * unit, NOISE_MARGIN * curve.noise)
    bounds = [None, *(int(frame) for frame in maxima), None]
    return tuple(_minimum(values, left, right, near, unit) for left, right in pairwise(bounds))


def median_maximum(values: FloatArray) -> tuple[float, FloatArray]:
    """The median of the clear maxima of `values` (n,), and their frames.

    Without a clear maximum, the largest value and no frames are returned.
    """
    high = float(quantile(values, HIGH_QUANTILE))
    maxima, _ = scipy.signal.find_peaks(values, prominence=max(MIN_PROMINENCE * high, 1e-12))
    if not len(maxima):
        return float(values.max()), maxima
    unit = float(median(values[maxima]))
    standing, _ = scipy.signal.find_peaks(values, prominence=MIN_PROMINENCE * unit)
    return unit, standing


def turning_minimum(frame: int, energy: float) -> EnergyMinimum:
    """A turning point at `frame` as a minimum; energy: there, in units of the median maximum."""
    return EnergyMinimum(frame, frame, frame, energy, 0.0, at_start=False, at_end=False)


def usual_length(minima: tuple[EnergyMinimum, ...]) -> float:
    """The frames that a minimum usually lasts: the median of the certain ones within the clip."""
    lengths = [
        minimum.length
        for minimum in minima
        if minimum.energy < CERTAIN_ENERGY and not minimum.at_start and not minimum.at_end
    ]
    return float(np.median(lengths)) if lengths else DEFAULT_LENGTH


def _minimum(
    values: FloatArray, left: int | None, right: int | None, near: float, unit: float
) -> EnergyMinimum:
    """The minimum between maxima at frames `left` and `right`; None stands for an end of the clip.

    near: how far above the least energy the minimum reaches. unit: the median maximum.
    """
    start, stop = left or 0, len(values) if right is None else right + 1
    lowest = start + int(np.argmin(values[start:stop]))
    least = float(values[lowest])
    low = start + np.flatnonzero(values[start:stop] <= least + near)
    first, last = int(low[0]), int(low[-1])
    quiet = least + max(near, END_MARGIN * unit)
    at_start = left is None and bool(values[:first].max(initial=0.0) <= quiet)
    at_end = right is None and bool(values[last:].max(initial=0.0) <= quiet)
    lower_maximum = min(float(values[maximum]) for maximum in (left, right) if maximum is not None)
    return EnergyMinimum(
        lowest=lowest,
        first=0 if at_start else first,
        last=len(values) - 1 if at_end else last,
        energy=least / unit,
        drop=(lower_maximum - least) / unit,
        at_start=at_start,
        at_end=at_end,
    )
