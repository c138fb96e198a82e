"""Rests: the valleys of an energy curve, one between any two maxima that stand out.

A dancer who holds a pose shakes, breathes and lets a hand play: energy then has many small
minima, all in one valley. Energies are told in units of the curve's median maximum, so that
thresholds on them need no unit and fit calm and wild dances alike.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy

from app.analysis.energy.energy import EnergyCurve
from app.numerics.arrays import FloatArray

STANDS_OUT = 0.25
"""Units by which a maximum must rise above the valleys beside it to part them."""

HIGH = 0.9
"""Quantile of a curve that serves as its unit until its median maximum is known."""

NEAR_MINIMUM = 0.045
"""Units above a valley's least energy that still belong to the rest."""

NOISE_NEAR_MINIMUM = 0.6
"""Share of the noise taken off that is left as ripple."""

END_OF_CLIP = 0.35
"""Units: a clip whose energy from its beginning to a rest is lower begins at rest."""

STILL = 0.03
"""Body lengths per second: a body whose maxima are lower only breathes and sways."""

SURE_MINIMUM = 0.25
"""Units of least energy below which a valley tells how long rests last."""

USUAL_LENGTH = 4.0
"""Frames that a rest lasts where none is sure."""


@dataclass(frozen=True, slots=True)
class EnergyMinimum:
    """A valley of an energy curve; frames, and energies in units of the median maximum.

    lowest: frame of least energy; first, last: frames between which energy stays near it;
    energy: at `lowest`; drop: from the lower of the maxima beside it down to `lowest`;
    at_start, at_end: whether the clip begins or ends at this rest.
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
        """Frames from first to last."""
        return self.last - self.first


def find_energy_minima(curve: EnergyCurve) -> tuple[EnergyMinimum, ...]:
    """The rests of an energy curve, in order; none of what does not move."""
    values = curve.values
    unit, maxima = median_maximum(values)
    if not len(maxima) or unit < max(STILL, curve.noise):
        return ()
    near = max(NEAR_MINIMUM * unit, NOISE_NEAR_MINIMUM * curve.noise)
    walls = [None, *(int(frame) for frame in maxima), None]
    return tuple(_minimum(values, left, right, near, unit) for left, right in pairwise(walls))


def median_maximum(values: FloatArray) -> tuple[float, FloatArray]:
    """The median of the maxima that stand out, and their frames; its maximum where none do."""
    high = float(np.quantile(values, HIGH))
    maxima, _ = scipy.signal.find_peaks(values, prominence=max(STANDS_OUT * high, 1e-12))
    if not len(maxima):
        return float(values.max()), maxima
    unit = float(np.median(values[maxima]))
    standing, _ = scipy.signal.find_peaks(values, prominence=STANDS_OUT * unit)
    return unit, standing


def usual_length(minima: tuple[EnergyMinimum, ...]) -> float:
    """Frames that a rest lasts: the median of those within the clip that are sure."""
    lengths = [
        minimum.length
        for minimum in minima
        if minimum.energy < SURE_MINIMUM and not minimum.at_start and not minimum.at_end
    ]
    return float(np.median(lengths)) if lengths else USUAL_LENGTH


def _minimum(
    values: FloatArray, left: int | None, right: int | None, near: float, unit: float
) -> EnergyMinimum:
    """The rest between maxima at frames `left` and `right`, None where the clip ends."""
    start, stop = left or 0, len(values) if right is None else right + 1
    lowest = start + int(np.argmin(values[start:stop]))
    least = float(values[lowest])
    low = start + np.flatnonzero(values[start:stop] <= least + near)
    first, last = int(low[0]), int(low[-1])
    quiet = least + max(near, END_OF_CLIP * unit)
    at_start = left is None and bool(values[:first].max(initial=0.0) <= quiet)
    at_end = right is None and bool(values[last:].max(initial=0.0) <= quiet)
    beside = min(float(values[wall]) for wall in (left, right) if wall is not None)
    return EnergyMinimum(
        lowest=lowest,
        first=0 if at_start else first,
        last=len(values) - 1 if at_end else last,
        energy=least / unit,
        drop=(beside - least) / unit,
        at_start=at_start,
        at_end=at_end,
    )
