"""Mean and standard deviation of the gait parameters by side, and the symmetry of the sides."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.analysis.gait.parameters import PARAMETERS, GaitParameter
from app.analysis.gait.strides import Stride


@dataclass(frozen=True, slots=True)
class Spread:
    """The mean of `count` values and their sample standard deviation (divisor count - 1). NaN
    where there are too few values."""

    mean: float
    sd: float
    count: int


@dataclass(frozen=True, slots=True)
class GaitRow:
    """A parameter over the strides of the left side, of the right side, and of both.

    symmetry: percent, see `symmetry_index`.
    """

    parameter: GaitParameter
    left: Spread
    right: Spread
    both: Spread
    symmetry: float


def summarize(strides: Sequence[Stride]) -> list[GaitRow]:
    """A row for each of PARAMETERS."""
    return [_row(parameter, strides) for parameter in PARAMETERS]


def spread(values: Sequence[float]) -> Spread:
    """The mean and the standard deviation of the values that are not NaN."""
    known = np.array([value for value in values if not math.isnan(value)])
    mean = float(known.mean()) if len(known) else math.nan
    deviation = float(known.std(ddof=1)) if len(known) > 1 else math.nan
    return Spread(mean, deviation, len(known))


def symmetry_index(left: float, right: float) -> float:
    """The difference of right and left in percent of their mean: 0 is symmetry, above 0 the right
    side has more.

    Source: Robinson, Herzog and Nigg (1987), who use it for forces. NaN where a mean is unknown or
    both add up to nothing.
    """
    mean = 0.5 * (left + right)
    if math.isnan(mean) or abs(mean) < 1e-9:
        return math.nan
    return 100.0 * (right - left) / mean


def _row(parameter: GaitParameter, strides: Sequence[Stride]) -> GaitRow:
    left, right = (
        spread([parameter.of(stride) for stride in strides if stride.side == side])
        for side in ("left", "right")
    )
    both = spread([parameter.of(stride) for stride in strides])
    return GaitRow(parameter, left, right, both, symmetry_index(left.mean, right.mean))
