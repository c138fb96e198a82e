"""Differences and continuations along the first axis, as numpy's `gradient` and `pad` make them.

The results are the same bit for bit. For the short arrays of one clip, numpy's functions spend
most of their time on options that are not needed here.
"""

from __future__ import annotations

import numpy as np

from app.numerics.arrays import FloatArray


def central_differences(values: FloatArray) -> FloatArray:
    """(n, ...) the change per step of `values` (n, ...), n >= 2; one-sided at both ends."""
    changes = np.empty_like(values)
    np.subtract(values[2:], values[:-2], out=changes[1:-1])
    changes[1:-1] /= 2.0
    changes[0] = values[1] - values[0]
    changes[-1] = values[-1] - values[-2]
    return changes


def point_reflected(values: FloatArray, reach: int) -> FloatArray:
    """(reach + n + reach, ...) `values` (n, ...), continued by point reflection at both ends."""
    if not 0 < reach < len(values):  # a continuation that is reflected several times
        width = [(reach, reach)] + [(0, 0)] * (values.ndim - 1)
        return np.pad(values, width, mode="reflect", reflect_type="odd")
    before = 2 * values[:1] - values[reach:0:-1]
    after = 2 * values[-1:] - values[-2 : -reach - 2 : -1]
    return np.concatenate([before, values, after])
