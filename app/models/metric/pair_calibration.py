"""Converts the distance of two clips to the probability that they have the same label.

A logistic curve is fitted to held-out pairs with the regularized targets of Platt ("Probabilistic
outputs for support vector machines", 1999). So a few cleanly separated pairs do not make the curve
a step. The pairs are as frequent as in the library, so the probability is that of a random pair.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from app.numerics.arrays import BoolArray, FloatArray

LEVELS = (-12.0, 12.0)
"""Bounds of the level."""
SLOPES = (0.5, 200.0)
"""Bounds of the slope. The score must fall with the distance even if the pairs carry no
information, and different printed distances must not round to the same score."""

START = (3.0, 6.0)
"""Level and slope of a fit without pairs of both kinds: probability 0.5 at distance 0.5."""


@dataclass(frozen=True, slots=True)
class PairCalibration:
    """Probability 1 / (1 + exp(slope d - level)) of the same label at distance d >= 0."""

    level: float
    slope: float

    def probability(self, distance: float) -> float:
        """0..1; falls strictly with the distance."""
        return float(self.probabilities(np.array([distance]))[0])

    def probabilities(self, distances: FloatArray) -> FloatArray:
        """(n,) `probability` of each of `distances` (n,)."""
        return np.asarray(1.0 / (1.0 + np.exp(self.slope * distances - self.level)))


def calibrate_pairs(distances: FloatArray, same: BoolArray) -> PairCalibration:
    """Fit the curve with maximum likelihood.

    distances: (n,) of the pairs; same: (n,) whether the two clips have the same label.
    """
    positive = int(np.count_nonzero(same))
    if not 0 < positive < len(same):
        return PairCalibration(*START)
    high, low = (positive + 1) / (positive + 2), 1 / (len(same) - positive + 2)
    targets = np.where(same, high, low)

    def loss(curve: FloatArray) -> tuple[float, FloatArray]:
        level, slope = curve
        odds = level - slope * distances
        errors = 1.0 / (1.0 + np.exp(-odds)) - targets
        mean_loss = float(np.mean(np.logaddexp(0.0, odds) - targets * odds))
        return mean_loss, np.array([errors.mean(), -np.mean(errors * distances)])

    result = scipy.optimize.minimize(
        loss, START, jac=True, method="L-BFGS-B", bounds=(LEVELS, SLOPES)
    )
    return PairCalibration(*(float(value) for value in result.x))
