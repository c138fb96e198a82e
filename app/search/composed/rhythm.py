"""How well the cycles of clips fit a rhythm."""

from __future__ import annotations

import numpy as np

from app.numerics.arrays import FloatArray

MULTIPLES = (1.0, 2.0)
"""A measured cycle may be several: two steps, say. So these multiples of its rate fit too."""


def rhythm_probabilities(
    cycle_times: FloatArray, cyclicity: FloatArray, rate: float, tolerance: float
) -> FloatArray:
    """(n,) how probably clips move in a rhythm: half of their cyclicity at the tolerance.

    cycle_times: (n,) seconds; cyclicity: (n,) 0..1, how exactly clips repeat; NaN for clips without
    them, which have probability 0. rate: cycles per minute; tolerance: a share of it, as .1.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        rates = 60.0 / np.asarray(cycle_times, dtype=np.float64)
        apart = np.min([np.abs(np.log(rates * many / rate)) for many in MULTIPLES], axis=0)
        likely = np.clip(cyclicity, 0.0, 1.0) * 0.5 ** ((apart / np.log1p(tolerance)) ** 2)
    return np.asarray(np.nan_to_num(likely, nan=0.0, posinf=0.0, neginf=0.0))
