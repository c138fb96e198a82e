"""Numbers rounded to significant digits, of whole arrays at once."""

from __future__ import annotations

import numpy as np

from app.numerics.arrays import FloatArray


def rounded(values: FloatArray, digits: int) -> FloatArray:
    """`values` rounded to `digits` significant digits, float64; NaN stays NaN.

    The result is the nearest float of the rounded decimal, so its text has at most `digits` digits.
    """
    numbers = np.asarray(values, dtype=np.float64)
    with np.errstate(divide="ignore", invalid="ignore"):
        powers = np.floor(np.log10(np.abs(numbers)))
    # 0 and NaN have no power of ten; beyond 300, the scale would leave the range of floats
    powers = np.clip(np.where(np.isfinite(powers), powers, 0.0), -300.0, 300.0)
    decimals = (digits - 1 - powers).astype(np.int64)
    # a positive power of ten is exact up to 22, a negative one never is: so one divides instead
    scale = 10.0 ** np.abs(decimals)
    with np.errstate(over="ignore", invalid="ignore"):  # in the branch that is not taken
        small = np.round(numbers * scale) / scale
        large = np.round(numbers / scale) * scale
    return np.where(decimals >= 0, small, large)
