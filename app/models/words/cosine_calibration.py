"""Calibration of the correlated space: converts angles to probabilities, learned on held-out clips.

An angle does not show how common a word is: a clip at the same angle to *walk* and to *juggle* is
more likely a walk. So one logistic curve for all words depends on the cosine and on the log odds
that a clip carries the word. On 501 real clips, held out, its Brier score for single words is
.0405; it is .0466 for a monotone curve of the cosine alone, and .0457 for the words' frequencies.
For whole label sets, which were not part of the fit, it is .0073 instead of .0078.

The search for clips by words and the search for words by clips have different angles (Takano,
sections 2.3 and 2.4), so each has its own curve. Shapes: clips N, words V.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from app.models.folds import grouped_folds
from app.models.words.correlated_space import (
    MIN_CLIPS,
    RIDGE,
    CorrelatedSpace,
    fit_correlated_space,
)
from app.numerics.arrays import FloatArray

FOLDS = 5
MAX_CLIPS = 2000
"""Largest number of clips of the calibration; more clips change its three numbers very little."""

LEVELS, SLOPES, WEIGHTS = (-10.0, 10.0), (0.05, 50.0), (0.0, 2.0)
"""Bounds of level, slope and weight. With them, a score always rises with the cosine, and never
falls with the frequency of a word."""

START = (0.0, 4.0, 1.0)
"""Level, slope and weight if there are too few clips to hold some out."""


@dataclass(frozen=True, slots=True)
class CosineCalibration:
    """Probability 1 / (1 + exp(-level - slope cosine - weight ln(share / (1 - share)))).

    shares: (V,) the share of clips that have each word, in (0, 1).
    """

    shares: FloatArray
    level: float
    slope: float
    weight: float

    def probabilities(self, cosines: FloatArray, shares: FloatArray | float) -> FloatArray:
        """Probabilities of `cosines` (any shape), strictly ascending with them.

        shares: the share of clips that have the words of each cosine; it must broadcast.
        """
        odds = self.level + self.slope * cosines + self.weight * _log_odds(shares)
        return np.asarray(1.0 / (1.0 + np.exp(-odds)))

    def of_words(self, cosines: FloatArray) -> FloatArray:
        """(N, V) probability that each clip has each word, by the cosines (N, V)."""
        return self.probabilities(cosines, self.shares)

    def to_arrays(self) -> tuple[dict[str, np.ndarray[Any, Any]], dict[str, Any]]:
        """Arrays and JSON-able metadata for `from_arrays`."""
        meta = {"level": self.level, "slope": self.slope, "weight": self.weight}
        return {"shares": self.shares}, meta

    @classmethod
    def from_arrays(
        cls, arrays: Mapping[str, np.ndarray[Any, Any]], meta: Mapping[str, Any]
    ) -> CosineCalibration:
        """The calibration from the result of `to_arrays`."""
        return cls(arrays["shares"], meta["level"], meta["slope"], meta["weight"])


@dataclass(frozen=True, slots=True)
class Calibrated:
    """A calibration, and the mean log loss of the held-out clips that it was fitted on; without
    held-out clips, that of the words' shares."""

    curve: CosineCalibration
    loss: float


Cosines = Callable[[CorrelatedSpace, FloatArray], FloatArray]
"""Computes cosines (N, V) from a space and symbol coordinates (N, d). It is
CorrelatedSpace.single_word_cosines to find clips by words, and CorrelatedSpace.word_cosines to find
words by clips; for the paper's own space, the negative distances instead."""


def calibrate_cosines(
    points: FloatArray,
    labels: FloatArray,
    groups: Sequence[str],
    cosines_of: Cosines = CorrelatedSpace.single_word_cosines,
    *,
    ridge: float = RIDGE,
    seed: int = 0,
) -> Calibrated:
    """Learn the relation between cosines in a correlated space and the words of held-out clips.

    points: (n, d) symbol coordinates; labels: (n, V); groups: n, clips of one group are held out
    together; ridge: of the space. Deterministic for a seed.
    """
    # half a clip more, so that no share is 0 or 1
    shares = (labels.sum(axis=0) + 0.5) / (len(labels) + 1.0)
    chosen = np.sort(np.random.RandomState(seed).permutation(len(points))[:MAX_CLIPS])
    rows, truth, own = points[chosen], labels[chosen], [groups[row] for row in chosen]
    folds = min(FOLDS, len(set(own)))
    unjudged = Calibrated(CosineCalibration(shares, *START), _loss_of_shares(shares))
    if folds < 2:
        return unjudged
    fold = grouped_folds(own, folds, seed=seed)
    # every fold must leave enough clips for a correlated space
    if np.bincount(fold).max() > len(rows) - MIN_CLIPS:
        return unjudged
    cosines = np.zeros(truth.shape)
    for one in range(folds):
        held_out = fold == one
        space = fit_correlated_space(rows[~held_out], truth[~held_out], ridge=ridge)
        cosines[held_out] = cosines_of(space, rows[held_out])
    curve, loss = _likeliest(cosines, shares, truth)
    return Calibrated(CosineCalibration(shares, *curve), loss)


def _loss_of_shares(shares: FloatArray) -> float:
    return float(-(shares * np.log(shares) + (1.0 - shares) * np.log1p(-shares)).mean())


def _likeliest(
    cosines: FloatArray, shares: FloatArray, truth: FloatArray
) -> tuple[tuple[float, float, float], float]:
    """Level, slope and weight with the largest likelihood of `truth` (n, V), and their loss."""
    terms = np.stack(
        [np.ones(cosines.size), cosines.ravel(), np.tile(_log_odds(shares), len(cosines))], axis=1
    )
    is_true = truth.ravel()

    def loss(curve: FloatArray) -> tuple[float, FloatArray]:
        odds = terms @ curve
        errors = 1.0 / (1.0 + np.exp(-odds)) - is_true
        return float(np.mean(np.logaddexp(0.0, odds) - is_true * odds)), errors @ terms / len(terms)

    bounds = (LEVELS, SLOPES, WEIGHTS)
    found = scipy.optimize.minimize(loss, START, jac=True, method="L-BFGS-B", bounds=bounds)
    level, slope, weight = found.x
    return (float(level), float(slope), float(weight)), float(found.fun)


def _log_odds(shares: FloatArray | float) -> FloatArray:
    return np.asarray(np.log(shares) - np.log1p(-np.asarray(shares)))
