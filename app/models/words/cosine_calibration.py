"""From angles in the correlated space to probabilities, learned on clips that were held out.

An angle alone says nothing of how common a word is: a clip at the same angle to *walk* and to
*juggle* is likelier to be walked. One logistic curve therefore serves all words, over the
cosine and the log odds that any clip carries the word. Held out on 501 real clips its Brier
score is .0405 for single words, against .0466 for a rising curve of the cosine alone and .0457
for the words' frequencies; of whole label sets, which it never saw, .0073 against .0078.
Clips for words and words for clips lie at other angles (Takano, sections 2.3 and 2.4), so each
has a curve of its own. Shapes: clips N, words V.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from app.models.folds import grouped_folds
from app.models.words.correlated_space import MIN_CLIPS, CorrelatedSpace, fit_correlated_space
from app.numerics.arrays import FloatArray

FOLDS = 5
MAX_CLIPS = 2000
"""Clips on which the curve is learned: more do not change three numbers."""

LEVELS, SLOPES, WEIGHTS = (-10.0, 10.0), (0.5, 50.0), (0.0, 2.0)
"""Bounds: a score rises with the cosine and with how common a word is, whatever the clips say."""

START = (0.0, 4.0, 1.0)
"""Level, slope and weight where too few clips are there to hold some out."""


@dataclass(frozen=True, slots=True)
class CosineCalibration:
    """Probability 1 / (1 + exp(-level - slope cosine - weight ln(share / (1 - share)))).

    shares: (V,) how much of the clips carry each word, above 0 and below 1.
    """

    shares: FloatArray
    level: float
    slope: float
    weight: float

    def probabilities(self, cosines: FloatArray, shares: FloatArray | float) -> FloatArray:
        """Of the same shape as `cosines`, strictly rising with them.

        shares: of the clips that carry what was asked for, to go with the cosines.
        """
        odds = self.level + self.slope * cosines + self.weight * _log_odds(shares)
        return np.asarray(1.0 / (1.0 + np.exp(-odds)))

    def of_words(self, cosines: FloatArray) -> FloatArray:
        """(N, V) probability that each clip carries each word, by the cosines (N, V)."""
        return self.probabilities(cosines, self.shares)

    def to_arrays(self) -> tuple[dict[str, np.ndarray[Any, Any]], dict[str, Any]]:
        """Arrays and JSON-able meta from which from_arrays makes the same record."""
        meta = {"level": self.level, "slope": self.slope, "weight": self.weight}
        return {"shares": self.shares}, meta

    @classmethod
    def from_arrays(
        cls, arrays: Mapping[str, np.ndarray[Any, Any]], meta: Mapping[str, Any]
    ) -> CosineCalibration:
        """The record that to_arrays took apart."""
        return cls(arrays["shares"], meta["level"], meta["slope"], meta["weight"])


Cosines = Callable[[CorrelatedSpace, FloatArray], FloatArray]
"""(N, V) of a space and symbol coordinates (N, d): CorrelatedSpace.single_word_cosines, where
words ask for clips, or CorrelatedSpace.word_cosines, where clips ask for words."""


def calibrate_cosines(
    points: FloatArray,
    labels: FloatArray,
    groups: Sequence[str],
    cosines_of: Cosines = CorrelatedSpace.single_word_cosines,
    *,
    seed: int = 0,
) -> CosineCalibration:
    """Learn how cosines in a correlated space relate to what held-out clips carry.

    points: (n, d) symbol coordinates; labels: (n, V); groups: n, whose members are never
    parted. Deterministic for a seed.
    """
    shares = (labels.sum(axis=0) + 0.5) / (len(labels) + 1.0)
    chosen = np.sort(np.random.RandomState(seed).permutation(len(points))[:MAX_CLIPS])
    rows, truth, own = points[chosen], labels[chosen], [groups[row] for row in chosen]
    folds = min(FOLDS, len(set(own)))
    if folds < 2:
        return CosineCalibration(shares, *START)
    fold = grouped_folds(own, folds, seed=seed)
    if np.bincount(fold).max() > len(rows) - MIN_CLIPS:
        return CosineCalibration(shares, *START)
    cosines = np.zeros(truth.shape)
    for one in range(folds):
        held = fold == one
        taught = fit_correlated_space(rows[~held], truth[~held])
        cosines[held] = cosines_of(taught, rows[held])
    return CosineCalibration(shares, *_likeliest(cosines, shares, truth))


def _likeliest(
    cosines: FloatArray, shares: FloatArray, truth: FloatArray
) -> tuple[float, float, float]:
    """Level, slope and weight under which `truth` (n, V) is least surprising."""
    told = np.stack(
        [np.ones(cosines.size), cosines.ravel(), np.tile(_log_odds(shares), len(cosines))], axis=1
    )
    is_so = truth.ravel()

    def loss(curve: FloatArray) -> tuple[float, FloatArray]:
        odds = told @ curve
        missed = 1.0 / (1.0 + np.exp(-odds)) - is_so
        return float(np.mean(np.logaddexp(0.0, odds) - is_so * odds)), missed @ told / len(told)

    bounds = (LEVELS, SLOPES, WEIGHTS)
    level, slope, weight = scipy.optimize.minimize(
        loss, START, jac=True, method="L-BFGS-B", bounds=bounds
    ).x
    return float(level), float(slope), float(weight)


def _log_odds(shares: FloatArray | float) -> FloatArray:
    return np.asarray(np.log(shares) - np.log1p(-np.asarray(shares)))
