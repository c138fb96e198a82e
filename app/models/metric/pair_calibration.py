"""From the distance of two clips to the probability that they carry the same label.

A logistic curve over held-out pairs with the regularised targets of Platt ("Probabilistic
outputs for support vector machines", 1999), so that a few pairs that part cleanly do not make
it a step. Pairs come as often as they do in the library, so that the probability is that of a
pair drawn from it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from app.numerics.arrays import BoolArray, FloatArray

LEVELS = (-12.0, 12.0)
SLOPES = (0.5, 200.0)
"""Bounds. A score must fall with distance, also where the pairs tell nothing, and no distance
that is told may round to the same score as the next."""

START = (3.0, 6.0)
"""Level and slope without pairs of both kinds: one half at a distance of one half."""


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
    """The curve under which what `same` (n,) says of pairs at `distances` (n,) is likeliest."""
    positive = int(np.count_nonzero(same))
    if not 0 < positive < len(same):
        return PairCalibration(*START)
    high, low = (positive + 1) / (positive + 2), 1 / (len(same) - positive + 2)
    targets = np.where(same, high, low)

    def loss(curve: FloatArray) -> tuple[float, FloatArray]:
        level, slope = curve
        odds = level - slope * distances
        missed = 1.0 / (1.0 + np.exp(-odds)) - targets
        told = float(np.mean(np.logaddexp(0.0, odds) - targets * odds))
        return told, np.array([missed.mean(), -np.mean(missed * distances)])

    found = scipy.optimize.minimize(
        loss, START, jac=True, method="L-BFGS-B", bounds=(LEVELS, SLOPES)
    )
    return PairCalibration(*(float(value) for value in found.x))
