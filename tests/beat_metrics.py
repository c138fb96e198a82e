"""How well found beats continue the true ones (Davies, Degara & Plumbley 2009, section 3.3)."""

from __future__ import annotations

import numpy as np

from app.numerics.arrays import FloatArray

TOLERANCE = 0.175
"""Of an interval: the largest error of a beat and of the interval before it."""


def cml_total(found: FloatArray, true: FloatArray) -> float:
    """CMLt: the share of beats that are right, at the correct metrical level.

    found, true: (b,) seconds, rising. A beat is right if it and its interval agree with the nearest
    true beat and that one's interval.
    """
    if len(found) < 2 or len(true) < 2:
        return 0.0
    nearest = np.abs(found[:, None] - true).argmin(axis=1)
    intervals, own = _before(true)[nearest], _before(found)
    near = np.abs(found - true[nearest]) < TOLERANCE * intervals
    even = np.abs(1.0 - own / intervals) < TOLERANCE
    return float((near & even).sum() / max(len(found), len(true)))


def aml_total(found: FloatArray, true: FloatArray) -> float:
    """AMLt: the same at any allowed level: twice or half the tempo, or between the beats."""
    if len(true) < 4:
        return 0.0
    double = np.interp(np.arange(2 * len(true) - 1) / 2, np.arange(len(true)), true)
    levels = (true, double, double[1::2], true[::2], true[1::2])
    return max(cml_total(found, level) for level in levels)


def _before(beats: FloatArray) -> FloatArray:
    """(b,) the interval before each beat; that after the first one."""
    intervals = np.diff(beats)
    return np.concatenate([intervals[:1], intervals])
