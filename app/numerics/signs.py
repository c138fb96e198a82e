"""Signs of singular vectors and eigenvectors, fixed once and for all.

A singular vector is known only up to its sign, which differs between LAPACK builds.
What we store is compared for years, so each column is turned such that its entry of
largest magnitude is positive.
"""

from __future__ import annotations

import numpy as np

from app.numerics.arrays import FloatArray

_TIE = 1e-9
"""Entries this close to the largest magnitude (relative) count as equal to it: rounding
must not decide between two that are equal by symmetry. The first of them is taken."""


def column_signs(columns: FloatArray) -> FloatArray:
    """The factor +1 or -1 for each column of (rows, k), as (k,); +1 for a zero column."""
    if columns.shape[0] == 0:
        return np.ones(columns.shape[1])
    magnitudes = np.abs(columns)
    leading = np.argmax(magnitudes >= (1 - _TIE) * magnitudes.max(axis=0), axis=0)
    entries = columns[leading, np.arange(columns.shape[1])]
    return np.where(entries < 0, -1.0, 1.0)


def fix_signs(columns: FloatArray) -> FloatArray:
    """(rows, k) with each column turned so that its largest entry is positive."""
    return columns * column_signs(columns)
