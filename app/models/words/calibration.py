"""Calibration of the word model: converts outputs to probabilities, learned on held-out clips.

One monotone curve (isotonic regression) serves all words: the share of true (clip, word) pairs
among pairs with similar outputs. A query of several words requests clips with all of them. Since
words occur together, the probability is larger than the product of their probabilities.
Shapes: clips N, words V, words of a query q.
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
"""Largest number of clips of the calibration; more do not change the curve."""
SMOOTHING = 1e-3
"""Share of a logistic curve in the calibration, so that it rises strictly also beyond the held-out
outputs and below the smallest true one."""
MAX_SETS = 300
"""Largest number of label sets from which the dependence is learned."""
_DEPENDENCES = np.linspace(0.0, 1.0, 21)
"""Candidates for the dependence."""


@dataclass(frozen=True, slots=True)
class WordCalibration:
    """A fitted calibration.

    outputs: (k,) ascending; shares: (k,) ascending in 0..1, interpolated between the outputs;
    dependence: 1 if the words of a query are independent, 0 if one word implies all others.
    """

    outputs: FloatArray
    shares: FloatArray
    dependence: float

    def probabilities(self, outputs: FloatArray) -> FloatArray:
        """Probabilities of `outputs` (any shape), strictly ascending with them, in (0, 1)."""
        curve = np.interp(outputs, self.outputs, self.shares)
        # exp cannot overflow here, even for an output far from all training clips
        logistic = 1.0 / (1.0 + np.exp(-4.0 * np.clip(outputs - 0.5, -50.0, 50.0)))
        return np.asarray((1.0 - SMOOTHING) * curve + SMOOTHING * logistic)

    def joint_surprise(self, probabilities: FloatArray) -> FloatArray:
        """(N,) -ln of the probability that a clip has all q words.

        probabilities: (N, q) of the single words. The probability of all is their geometric mean
        to the power q^dependence. With dependence 1 this is their product.
        """
        count = probabilities.shape[1]
        smallest = np.finfo(np.float64).tiny
        mean = -np.log(np.maximum(probabilities, smallest, dtype=np.float64)).mean(axis=1)
        return np.asarray(mean * count**self.dependence)

    def to_arrays(self) -> tuple[dict[str, np.ndarray[Any, Any]], dict[str, Any]]:
        """Arrays and JSON-able metadata for `from_arrays`."""
        arrays = {"outputs": self.outputs, "shares": self.shares}
        return arrays, {"dependence": self.dependence}

    @classmethod
    def from_arrays(
        cls, arrays: Mapping[str, np.ndarray[Any, Any]], meta: Mapping[str, Any]
    ) -> WordCalibration:
        """The calibration from the result of `to_arrays`."""
        return cls(arrays["outputs"], arrays["shares"], float(meta["dependence"]))


IDENTITY_CALIBRATION = WordCalibration(np.array([0.0, 1.0]), np.array([0.0, 1.0]), 1.0)
"""The identity, for libraries with too few clips to hold some out."""


def calibrate(
    model: WordModel,
    statistics: FloatArray,
    labels: FloatArray,
    groups: Sequence[str],
    *,
    seed: int = 0,
) -> WordCalibration:
    """Learn the relation between the outputs of `model` and the words of held-out clips.

    model: fitted on all clips; the folds use the width and penalty of its kernel. statistics:
    (n, p); labels: (n, V); groups: n, clips of one group are held out together. Deterministic
    for a seed.
    """
    chosen = np.sort(np.random.RandomState(seed).permutation(len(statistics))[:MAX_CLIPS])
    rows, truth = np.asarray(statistics)[chosen], labels[chosen]
    own = [groups[row] for row in chosen]
    folds = min(FOLDS, len(set(own)))
    if folds < 2:
        return IDENTITY_CALIBRATION
    fold = grouped_folds(own, folds, seed=seed)
    outputs = np.zeros(truth.shape)
    for one in range(folds):
        held_out = fold == one
        fold_model = refit_word_model(model, rows[~held_out], truth[~held_out], seed=seed)
        outputs[held_out] = fold_model.outputs(rows[held_out])
    knots, shares = rising_means(outputs.ravel(), truth.ravel())
    curve = WordCalibration(knots, shares, 1.0)
    dependence = _dependence(curve.probabilities(outputs), truth, seed)
    return WordCalibration(knots, shares, dependence)


def _dependence(probabilities: FloatArray, labels: FloatArray, seed: int) -> float:
    """The dependence with the largest likelihood of the held-out label sets with several words."""
    sets = np.unique(labels[labels.sum(axis=1) > 1.0], axis=0)
    if not len(sets):
        return 1.0
    sets = sets[np.random.RandomState(seed).permutation(len(sets))[:MAX_SETS]]
    losses = np.zeros(len(_DEPENDENCES))
    for in_set in sets > 0.0:
        is_true = labels[:, in_set].all(axis=1)
        mean = -np.log(probabilities[:, in_set]).mean(axis=1)
        # (dependences, n) -ln of the probability that a clip has the whole set
        surprise = mean * float(in_set.sum()) ** _DEPENDENCES[:, None]
        losses += surprise[:, is_true].sum(axis=1)
        losses -= np.log1p(-np.exp(-surprise[:, ~is_true])).sum(axis=1)
    return float(_DEPENDENCES[np.argmin(losses)])
