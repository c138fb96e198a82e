"""Calibration of a recognizer: the temperature of its evidence, and the threshold of novelty.

evidence: (n, labels) log evidence of each label; novelty: (n,) the log evidence of a new label
minus that of all known labels; truth: (n,) the index of the true label, NEW for a label without
training clips. All of them come from held-out clips.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from app.numerics.area_under_curve import area_under_curve
from app.numerics.arrays import BoolArray, FloatArray, IntArray

NEW = -1
"""The index of a label without training clips."""

TEMPERATURES = np.geomspace(1.0, 100.0, 25)
SCALES = np.geomspace(0.5, 100.0, 25)
"""Candidates for the temperature and for the scale of a calibration."""

USUAL_FALSE_REJECTION = 0.02
"""Share of known clips that are called unknown, if the library is too small to hold labels out."""

MIN_CLIPS = 20
"""Clips, known and new, that are each needed to estimate their median and spread."""

MIN_BELIEF = 1e-9
"""Smallest belief that a clip is known. So the candidates of a surely new clip stay in order."""

TAIL = 0.05
"""Share of the known and of the new clips beyond which the gap between them is measured."""

MAX_FALSE_ACCEPTANCE = 0.1
"""Largest share of new held-out clips that the chosen threshold calls known."""

CURVE_POINTS = 50
"""Points of the curve of false acceptance against false rejection."""

_MIN_LOG = -1e30
"""The largest logarithm of an empty row."""


@dataclass(frozen=True, slots=True)
class Calibration:
    """A fitted calibration.

    temperature: divides the log evidence. threshold: a clip with a larger novelty is unknown.
    scale: the novelty over which the belief that a clip is known falls. known_novelty,
    new_novelty: sorted novelties of held-out known and new clips (or of simulated takes, see
    fit_calibration), from which the error rates at any threshold are computed.
    """

    temperature: float
    threshold: float
    scale: float
    known_novelty: FloatArray
    new_novelty: FloatArray

    @property
    def is_judged(self) -> bool:
        """Whether known and new clips could be held out: if not, no error rate is known."""
        return bool(len(self.known_novelty) and len(self.new_novelty))

    def to_arrays(self, name: str) -> tuple[dict[str, np.ndarray[Any, Any]], list[float]]:
        """Arrays, their names beginning with `name`, and JSON-able numbers."""
        arrays = {
            f"{name}_known_novelty": self.known_novelty,
            f"{name}_new_novelty": self.new_novelty,
        }
        return arrays, [self.temperature, self.threshold, self.scale]

    @classmethod
    def from_arrays(
        cls, name: str, arrays: Mapping[str, Any], numbers: Sequence[float]
    ) -> Calibration:
        """The calibration from the result of `to_arrays`."""
        temperature, threshold, scale = numbers
        known, new = arrays[f"{name}_known_novelty"], arrays[f"{name}_new_novelty"]
        return cls(temperature, threshold, scale, known, new)

    def beliefs(self, evidence: FloatArray, novelty: FloatArray) -> FloatArray:
        """(n, labels) belief in each label, 0..1. A row's sum is the belief that it is known."""
        known = np.maximum(sigmoid((self.threshold - novelty) / self.scale), MIN_BELIEF)
        return np.asarray(softmax(evidence / self.temperature) * known[:, None])

    def at_false_acceptance(self, rate: float) -> Calibration:
        """The same calibration with another threshold.

        It is the largest one that accepts at most the share `rate` (0 to less than 1) of the new
        held-out clips. Without such clips, the threshold stays as it is.
        """
        if not len(self.new_novelty):
            return self
        beyond = self.new_novelty[int(rate * len(self.new_novelty))]
        novelties = np.concatenate([self.known_novelty, self.new_novelty])
        within = novelties[novelties < beyond]
        middle = (within.max() + beyond) / 2 if len(within) else beyond - 1.0
        return replace(self, threshold=float(middle))

    def curve(self) -> list[tuple[float, float, float]]:
        """(threshold, false acceptance, false rejection) along the held-out clips' novelties."""
        novelties = np.unique(np.concatenate([self.known_novelty, self.new_novelty]))
        if not len(novelties):
            return []
        chosen = np.unique(np.linspace(0, len(novelties) - 1, CURVE_POINTS).round().astype(int))
        return [(float(t), *self.error_rates(float(t))) for t in novelties[chosen]]

    def area_under_curve(self) -> float:
        """The probability that a new clip has a larger novelty than a known clip."""
        return area_under_curve(self.new_novelty, self.known_novelty)

    def error_rates(self, threshold: float | None = None) -> tuple[float, float]:
        """(false acceptance of new, false rejection of known), shares of held-out clips."""
        at = self.threshold if threshold is None else threshold
        accepted = float((self.new_novelty <= at).mean()) if len(self.new_novelty) else 0.0
        rejected = float((self.known_novelty > at).mean()) if len(self.known_novelty) else 0.0
        return accepted, rejected


def no_calibration() -> Calibration:
    """Leaves the labels in the order of their evidence. It decides nothing about what is new."""
    return Calibration(1.0, 0.0, 1.0, np.zeros(0), np.zeros(0))


def fit_calibration(
    evidence: FloatArray,
    novelty: FloatArray,
    truth: IntArray,
    seen: BoolArray | None = None,
    simulated: FloatArray | None = None,
    threshold: float | None = None,
) -> Calibration:
    """Calibrate on held-out clips; without any, the calibration has fixed values.

    seen: (n,) whether the same person at the same task was among the training clips; None for
    none. simulated: (m,) novelties of simulated further takes of the recorded cells. threshold: the
    one to use; None to choose it.

    A known clip that was not seen has a larger novelty than the clips of later requests. So the
    threshold and the error rates come from the seen clips, if there are MIN_CLIPS of them, else
    from the simulated takes.
    """
    known = truth != NEW
    new, scaled = novelty[~known], novelty[known]
    judged = novelty[known & seen] if seen is not None else novelty[:0]
    if len(judged) < MIN_CLIPS and simulated is not None:
        judged = scaled = simulated
    if min(len(judged), len(new)) >= MIN_CLIPS:
        chosen = _between_tails(judged, new, simulated=judged is simulated)
    else:
        judged = scaled = novelty[known]
        chosen = _threshold(judged, new)
    threshold = chosen if threshold is None else threshold
    return Calibration(
        temperature=_temperature(evidence[known], truth[known]),
        threshold=threshold,
        scale=_scale(scaled - threshold, new - threshold),
        known_novelty=np.sort(judged),
        new_novelty=np.sort(new),
    )


def softmax(logs: FloatArray) -> FloatArray:
    """(n, k) shares that sum to 1 in each row, from log weights (n, k)."""
    shares = np.exp(logs - logs.max(axis=1, keepdims=True, initial=_MIN_LOG))
    return np.asarray(shares / np.maximum(shares.sum(axis=1, keepdims=True), 1e-300))


def sigmoid(x: FloatArray) -> FloatArray:
    """1 / (1 + exp(-x)) without overflow."""
    return np.asarray(0.5 * (1 + np.tanh(0.5 * x)))


def _temperature(evidence: FloatArray, truth: IntArray) -> float:
    """The temperature with the largest likelihood of the true labels; 1 without held-out clips."""
    if not len(truth):
        return 1.0
    rows = np.arange(len(truth))
    loss = [
        -np.log(np.maximum(softmax(evidence / t)[rows, truth], 1e-12)).mean() for t in TEMPERATURES
    ]
    return float(TEMPERATURES[int(np.argmin(loss))])


def _threshold(known: FloatArray, new: FloatArray) -> float:
    """The novelty that best separates known from new clips; both kinds have the same weight."""
    if not len(known):
        return 0.0
    if not len(new):
        return max(float(np.quantile(known, 1 - USUAL_FALSE_REJECTION)), 0.0)
    cuts = np.unique(np.concatenate([known, new]))
    cuts = np.concatenate([[cuts[0] - 1.0], (cuts[1:] + cuts[:-1]) / 2, [cuts[-1] + 1.0]])
    accepted = np.searchsorted(np.sort(new), cuts, side="right") / len(new)
    rejected = 1 - np.searchsorted(np.sort(known), cuts, side="right") / len(known)
    best = np.flatnonzero(accepted + rejected <= (accepted + rejected).min() + 1e-12)
    return float(np.median(cuts[best]))  # if they separate cleanly, the middle of the gap


def _between_tails(known: FloatArray, new: FloatArray, *, simulated: bool) -> float:
    """The middle between the highest known and the lowest new clips, less the TAIL of each.

    If they overlap, at most MAX_FALSE_ACCEPTANCE of the new clips are called known: to name the
    wrong person is worse than to name none. If there is a gap above simulated takes, the threshold
    is near to these: the gap is too wide, since real takes are not as alike.
    """
    highest, lowest = float(np.quantile(known, 1 - TAIL)), float(np.quantile(new, TAIL))
    if simulated and highest < lowest:
        return _between_medians(known, new)
    return min((highest + lowest) / 2, float(np.quantile(new, MAX_FALSE_ACCEPTANCE)))


def _between_medians(known: FloatArray, new: FloatArray) -> float:
    """The novelty that is equally far from the medians of the known and of the new clips, each
    distance in interquartile ranges of its kind."""
    medians = np.array([float(np.median(part)) for part in (known, new)])
    ranges = np.array([_range(part) for part in (known, new)])
    return float((medians * ranges[::-1]).sum() / ranges.sum())


def _range(part: FloatArray) -> float:
    """The interquartile range, above 0."""
    return max(float(np.subtract(*np.quantile(part, [0.75, 0.25]))), 1e-9)


def _scale(known: FloatArray, new: FloatArray) -> float:
    """The scale of the logistic curve with the largest likelihood of the held-out clips.

    known, new: novelties minus the threshold; both kinds have the same weight.
    """
    if not len(known) or not len(new):
        return 1.0
    loss = [np.logaddexp(0, known / s).mean() + np.logaddexp(0, -new / s).mean() for s in SCALES]
    return float(SCALES[int(np.argmin(loss))])
