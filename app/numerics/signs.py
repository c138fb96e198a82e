"""Fixed signs for singular vectors and eigenvectors.

The sign of a singular vector is arbitrary and differs between LAPACK builds. Stored vectors are
compared with new ones for years. So signs are fixed: the entry of largest magnitude is positive.
"""

from __future__ import annotations

import numpy as np

from app.numerics.arrays import FloatArray

_TIE = 1e-9
"""Relative difference up to which an entry counts as equal to the largest magnitude. Rounding
must not decide between two entries that are equal by symmetry: the first of them is taken."""


def column_signs(columns: FloatArray) -> FloatArray:
    """(k,) the factor, +1 or -1, that makes the largest entry of each column positive.

    columns: (rows, k); rows may be 0. A zero column has the factor +1.
    """
    if columns.shape[0] == 0:
        return np.ones(columns.shape[1])
    magnitudes = np.abs(columns)
    leading = np.argmax(magnitudes >= (1 - _TIE) * magnitudes.max(axis=0), axis=0)
    entries = columns[leading, np.arange(columns.shape[1])]
    return np.where(entries < 0, -1.0, 1.0)


def fix_signs(columns: FloatArray) -> FloatArray:
    """`columns` (rows, k), each multiplied by its factor of `column_signs`."""
    return columns * column_signs(columns)
