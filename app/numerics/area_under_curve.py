"""The area under the ROC curve: how well a number separates positives from negatives.

It is the Mann-Whitney statistic as a share of all pairs (Hanley and McNeil 1982, "The meaning and
use of the area under a receiver operating characteristic curve", Radiology 143).
"""

from __future__ import annotations

import numpy as np

from app.numerics.arrays import FloatArray


def area_under_curve(positives: FloatArray, negatives: FloatArray) -> float:
    """The chance, 0..1, that a positive has a larger value than a negative.

    positives: (p,) and negatives: (n,) values of any unit, in any order. Equal values count
    half. Without positives or without negatives the result is 0.5, as for a guess.
    """
    # Imported here because it takes half a second, and few commands need an area.
    from scipy.stats import rankdata

    if not len(positives) or not len(negatives):
        return 0.5
    # equal values share the mean of their ranks
    ranks = rankdata(np.concatenate([positives, negatives]))[: len(positives)]
    above = ranks.sum() - len(positives) * (len(positives) + 1) / 2
    return float(above / (len(positives) * len(negatives)))
