"""From the word model's outputs to probabilities, learned on clips that were held out.

One monotone curve serves all words: the share of (clip, word) pairs that are so, among pairs
of like output (isotonic regression). A query of several words asks for clips that carry all
of them; since words go together, that is likelier than the product of their probabilities.
Shapes: clips N, words V, asked words q.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.models.folds import grouped_folds
from app.models.words.model import WordModel, refit_word_model
from app.numerics.arrays import FloatArray
from app.numerics.isotonic import rising_means

FOLDS = 5
MAX_CLIPS = 2000
"""Clips on which the calibration is learned: more do not change the curve."""
SMOOTHING = 1e-3
"""Share of a logistic curve in the calibration: where no held-out output lay, and below those
that were ever right, more is still likelier than less."""
MAX_SETS = 300
_DEPENDENCES = np.linspace(0.0, 1.0, 21)


@dataclass(frozen=True, slots=True)
class WordCalibration:
    """outputs: (k,) rising, shares: (k,) rising in 0..1, between which is interpolated;
    dependence: 1 where words of a query are independent, 0 where one brings all others along.
    """

    outputs: FloatArray
    shares: FloatArray
    dependence: float

    def probabilities(self, outputs: FloatArray) -> FloatArray:
        """Of the same shape as `outputs`, strictly rising with them, above 0 and below 1."""
        curve = np.interp(outputs, self.outputs, self.shares)
        # exp never overflows here, whatever an output far from all training clips may be
        logistic = 1.0 / (1.0 + np.exp(-4.0 * np.clip(outputs - 0.5, -50.0, 50.0)))
        return np.asarray((1.0 - SMOOTHING) * curve + SMOOTHING * logistic)

    def joint_surprise(self, probabilities: FloatArray) -> FloatArray:
        """(N,) -ln of the probability that a clip carries all q words, from those of each (N, q).

        The geometric mean to the power q^dependence: their product where dependence is 1.
        """
        count = probabilities.shape[1]
        smallest = np.finfo(np.float64).tiny
        mean = -np.log(np.maximum(probabilities, smallest, dtype=np.float64)).mean(axis=1)
        return np.asarray(mean * count**self.dependence)

    def to_arrays(self) -> tuple[dict[str, np.ndarray[Any, Any]], dict[str, Any]]:
        """Arrays and JSON-able meta from which from_arrays makes the same record."""
        arrays = {"outputs": self.outputs, "shares": self.shares}
        return arrays, {"dependence": self.dependence}

    @classmethod
    def from_arrays(
        cls, arrays: Mapping[str, np.ndarray[Any, Any]], meta: Mapping[str, Any]
    ) -> WordCalibration:
        """The record that to_arrays took apart."""
        return cls(arrays["outputs"], arrays["shares"], float(meta["dependence"]))


AS_THEY_ARE = WordCalibration(np.array([0.0, 1.0]), np.array([0.0, 1.0]), 1.0)
"""Outputs taken for probabilities: where too few clips are there to hold some out."""


def calibrate(
    model: WordModel,
    statistics: FloatArray,
    labels: FloatArray,
    groups: Sequence[str],
    *,
    seed: int = 0,
) -> WordCalibration:
    """Learn how outputs of such a model relate to what held-out clips carry.

    model: fitted on all; its kernel's width and penalty serve the folds. statistics: (n, p);
    labels: (n, V); groups: n, whose members are never parted. Deterministic for a seed.
    """
    chosen = np.sort(np.random.RandomState(seed).permutation(len(statistics))[:MAX_CLIPS])
    rows, truth = np.asarray(statistics)[chosen], labels[chosen]
    own = [groups[row] for row in chosen]
    folds = min(FOLDS, len(set(own)))
    if folds < 2:
        return AS_THEY_ARE
    fold = grouped_folds(own, folds, seed=seed)
    outputs = np.zeros(truth.shape)
    for one in range(folds):
        held = fold == one
        taught = refit_word_model(model, rows[~held], truth[~held], seed=seed)
        outputs[held] = taught.outputs(rows[held])
    knots, shares = rising_means(outputs.ravel(), truth.ravel())
    curve = WordCalibration(knots, shares, 1.0)
    dependence = _dependence(curve.probabilities(outputs), truth, seed)
    return WordCalibration(knots, shares, dependence)


def _dependence(probabilities: FloatArray, labels: FloatArray, seed: int) -> float:
    """That under which the label sets of several words are least surprising, held out."""
    sets = np.unique(labels[labels.sum(axis=1) > 1.0], axis=0)
    if not len(sets):
        return 1.0
    sets = sets[np.random.RandomState(seed).permutation(len(sets))[:MAX_SETS]]
    losses = np.zeros(len(_DEPENDENCES))
    for wanted in sets > 0.0:
        is_so = labels[:, wanted].all(axis=1)
        mean = -np.log(probabilities[:, wanted]).mean(axis=1)
        surprise = mean * float(wanted.sum()) ** _DEPENDENCES[:, None]
        losses += surprise[:, is_so].sum(axis=1)
        losses -= np.log1p(-np.exp(-surprise[:, ~is_so])).sum(axis=1)
    return float(_DEPENDENCES[np.argmin(losses)])
