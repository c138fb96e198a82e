"""Calibration of the word model: converts outputs to probabilities, learned on held-out clips.

A monotone curve (isotonic regression) serves all words: the share of true (clip, word) pairs
among pairs with similar outputs. There are two curves, since an output means less for a clip that
is unlike all that was taught: one was learned with recordings held out, as for clips of the same
persons, the other with whole persons held out. How far a clip is from the nearest clip of the
model tells which curve counts how much (`Familiarity`): nearest distances of held-out recordings
and of held-out persons differ by a factor of two to four on real clips. Words of one source that
are asked of another have a mean log loss of .336 with both curves, and .355 with the first alone.

A query of several words requests clips with all of them. Since words occur together, the
probability is larger than the product of their probabilities. Shapes: clips N, words V, words of
a query q.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from app.models.folds import grouped_folds
from app.models.words.model import WordModel
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
MIN_DISTANCE = 1e-3
"""Nearest distances below it count as this: the clip itself taught the model."""
EVIDENCE = 0.5
"""Weight of a detector, for a clip unlike all that was taught. Words of one source that are asked
of another: mean average precision .657 for 27 cells of words that have a detector (.593 without
it, .529 by the statistics alone with one curve), log loss .196 (.264, .310); .661 and .205 with a
weight of .3, .645 and .197 with .7."""
_DEPENDENCES = np.linspace(0.0, 1.0, 21)
"""Candidates for the dependence."""


@dataclass(frozen=True, slots=True)
class Curve:
    """outputs: (k,) ascending; shares: (k,) ascending in 0..1, interpolated between the outputs."""

    outputs: FloatArray
    shares: FloatArray

    def probabilities(self, outputs: FloatArray) -> FloatArray:
        """Probabilities of `outputs` (any shape), strictly ascending with them, in (0, 1)."""
        curve = np.interp(outputs, self.outputs, self.shares)
        # exp cannot overflow here, even for an output far from all training clips
        logistic = 1.0 / (1.0 + np.exp(-4.0 * np.clip(outputs - 0.5, -50.0, 50.0)))
        return np.asarray((1.0 - SMOOTHING) * curve + SMOOTHING * logistic)


@dataclass(frozen=True, slots=True)
class Familiarity:
    """How much a clip is one of the taught persons: 1 / (1 + exp(slope (ln distance - middle)))."""

    middle: float
    slope: float

    def of(self, nearest: FloatArray) -> FloatArray:
        """(N,) 0..1 by the distances `nearest` (N,) to the nearest clip that taught the model."""
        logs = np.log(np.maximum(nearest, MIN_DISTANCE)) - self.middle
        return np.asarray(1.0 / (1.0 + np.exp(np.clip(self.slope * logs, -50.0, 50.0))))


@dataclass(frozen=True, slots=True)
class WordCalibration:
    """A fitted calibration.

    known, new: the curves for clips of taught persons, and of others; dependence: 1 if the words
    of a query are independent, 0 if one word implies all others.
    """

    known: Curve
    new: Curve
    familiarity: Familiarity
    dependence: float

    def probabilities(
        self, outputs: FloatArray, nearest: FloatArray, evidence: FloatArray | None = None
    ) -> FloatArray:
        """(N, V) probabilities of `outputs` (N, V), in (0, 1), strictly ascending with them.

        nearest: (N,) distance of each clip to the nearest one that taught the model. evidence:
        (N, V) probabilities by detectors (app.models.words.detectors), NaN without one.
        """
        known = self.familiarity.of(nearest)[:, None]
        own, other = self.known.probabilities(outputs), self.new.probabilities(outputs)
        if evidence is not None:
            mixed = (1.0 - EVIDENCE) * other + EVIDENCE * evidence
            other = np.where(np.isnan(evidence), other, mixed)
        return np.asarray(known * own + (1.0 - known) * other)

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
        arrays = {
            "outputs": self.known.outputs,
            "shares": self.known.shares,
            "new_outputs": self.new.outputs,
            "new_shares": self.new.shares,
        }
        middle, slope = self.familiarity.middle, self.familiarity.slope
        return arrays, {"dependence": self.dependence, "middle": middle, "slope": slope}

    @classmethod
    def from_arrays(
        cls, arrays: Mapping[str, np.ndarray[Any, Any]], meta: Mapping[str, Any]
    ) -> WordCalibration:
        """The calibration from the result of `to_arrays`."""
        return cls(
            Curve(arrays["outputs"], arrays["shares"]),
            Curve(arrays["new_outputs"], arrays["new_shares"]),
            Familiarity(float(meta["middle"]), float(meta["slope"])),
            float(meta["dependence"]),
        )


_IDENTITY = Curve(np.array([0.0, 1.0]), np.array([0.0, 1.0]))
IDENTITY_CALIBRATION = WordCalibration(_IDENTITY, _IDENTITY, Familiarity(0.0, 0.0), 1.0)
"""The identity, for libraries with too few clips to hold some out."""


def calibrate(
    model: WordModel,
    inputs: FloatArray,
    labels: FloatArray,
    groups: Sequence[str],
    persons: Sequence[str] | None = None,
    *,
    seed: int = 0,
) -> WordCalibration:
    """Learn the relation between the outputs of `model` and the words of held-out clips.

    model: fitted on all clips; the folds use the width and penalty of its kernels. inputs:
    (n, p); labels: (n, V); groups: n, clips of one recording are held out together; persons: n,
    clips of one person are held out together. Without persons, or with only one, all clips count
    as those of taught persons. Deterministic for a seed.
    """
    chosen = np.sort(np.random.RandomState(seed).permutation(len(inputs))[:MAX_CLIPS])
    rows, truth = np.asarray(inputs)[chosen], labels[chosen]
    held_out = _held_out(model, rows, truth, [groups[row] for row in chosen], seed)
    if held_out is None:
        return IDENTITY_CALIBRATION
    outputs, distances = held_out
    known = Curve(*rising_means(outputs.ravel(), truth.ravel()))
    dependence = _dependence(known.probabilities(outputs), truth, seed)
    strange = None
    if persons is not None:
        strange = _held_out(model, rows, truth, [persons[row] for row in chosen], seed)
    if strange is None:
        return WordCalibration(known, known, Familiarity(0.0, 0.0), dependence)
    new = Curve(*rising_means(strange[0].ravel(), truth.ravel()))
    return WordCalibration(known, new, _familiarity(distances, strange[1]), dependence)


def _held_out(
    model: WordModel, rows: FloatArray, labels: FloatArray, groups: Sequence[str], seed: int
) -> tuple[FloatArray, FloatArray] | None:
    """(n, V) outputs and (n,) nearest distances of clips whose group did not teach; None if there
    is only one group."""
    folds = min(FOLDS, len(set(groups)))
    if folds < 2:
        return None
    fold = grouped_folds(groups, folds, seed=seed)
    outputs, distances = np.zeros(labels.shape), np.zeros(len(rows))
    for one in range(folds):
        out = fold == one
        fold_model = model.refit(rows[~out], labels[~out], seed=seed)
        outputs[out] = fold_model.outputs(rows[out])
        distances[out] = fold_model.nearest(rows[out])
    return outputs, distances


def _familiarity(known: FloatArray, new: FloatArray) -> Familiarity:
    """The logistic curve that tells distances of known persons (n,) from those of new ones (n,)."""
    logs = np.log(np.maximum(np.concatenate([known, new]), MIN_DISTANCE))
    center, spread = float(logs.mean()), max(float(logs.std()), 1e-6)
    far = (logs - center) / spread
    sign = np.repeat([1.0, -1.0], [len(known), len(new)])

    def loss(curve: FloatArray) -> float:
        odds = sign * curve[1] * (far - curve[0])
        return float(np.logaddexp(0.0, odds).mean())

    bounds = ((-3.0, 3.0), (0.0, 10.0))
    middle, slope = scipy.optimize.minimize(loss, (0.0, 1.0), method="L-BFGS-B", bounds=bounds).x
    return Familiarity(center + spread * float(middle), float(slope) / spread)


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
