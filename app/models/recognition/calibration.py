"""Calibration of a recognizer: the temperature of its evidence, and the threshold of unknown.

evidence: (n, labels) log evidence of each label; novelty: (n,) the log evidence of something new
minus that of everything known; truth: (n,) the label index, NEW where the label was not among the
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

TEMPERATURES = np.geomspace(1.0, 100.0, 25)
SCALES = np.geomspace(0.5, 100.0, 25)

USUAL_FALSE_REJECTION = 0.02
"""Share of known clips refused if the library is too small to hold anything out as unknown."""

MIN_USUAL = 20
"""Clips of each kind that are needed to estimate its median and spread."""

MIN_BELIEF = 1e-9
"""Floor of the belief in being known, so that the labels of a surely new clip keep their order
as candidates."""

TAIL = 0.02
"""Share of the clips of each kind that is ignored when the gap between them is looked for."""

WIDE_GAP = 6.0
"""A gap of at least this width, in interquartile ranges of the known, alone sets the threshold."""

CURVE_POINTS = 50
"""Points of the curve of false acceptance against false rejection."""

_FAR = 1e30


@dataclass(frozen=True, slots=True)
class Calibration:
    """A fitted calibration.

    temperature: divides the log evidence. threshold: a clip with a larger novelty is unknown.
    scale: the novelty over which the belief in being known falls. known_novelty, new_novelty:
    sorted novelties of held-out clips (or of simulated ones, see fit_calibration), from which the
    error rates at any threshold are computed.
    """

    temperature: float
    threshold: float
    scale: float
    known_novelty: FloatArray
    new_novelty: FloatArray

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
        """(n, labels) belief in each label, 0..1, each row's sum = belief in being known."""
        known = np.maximum(sigmoid((self.threshold - novelty) / self.scale), MIN_BELIEF)
        return np.asarray(softmax(evidence / self.temperature) * known[:, None])

    def at_false_acceptance(self, rate: float) -> Calibration:
        """The same calibration with the largest threshold at which at most `rate` (0..1, below 1)
        of the new held-out clips are accepted. Without such clips it stays as it is."""
        if not len(self.new_novelty):
            return self
        beyond = self.new_novelty[int(rate * len(self.new_novelty))]
        every = np.concatenate([self.known_novelty, self.new_novelty])
        within = every[every < beyond]
        middle = (within.max() + beyond) / 2 if len(within) else beyond - 1.0
        return replace(self, threshold=float(middle))

    def curve(self) -> list[tuple[float, float, float]]:
        """(threshold, false acceptance, false rejection) along the held-out clips' novelties."""
        every = np.unique(np.concatenate([self.known_novelty, self.new_novelty]))
        if not len(every):
            return []
        chosen = np.unique(np.linspace(0, len(every) - 1, CURVE_POINTS).round().astype(int))
        return [(float(t), *self.error_rates(float(t))) for t in every[chosen]]

    def area_under_curve(self) -> float:
        """The chance that something new has a larger novelty than something known."""
        return area_under_curve(self.new_novelty, self.known_novelty)

    def error_rates(self, threshold: float | None = None) -> tuple[float, float]:
        """(false acceptance of new, false rejection of known), shares of held-out clips."""
        at = self.threshold if threshold is None else threshold
        accepted = float((self.new_novelty <= at).mean()) if len(self.new_novelty) else 0.0
        rejected = float((self.known_novelty > at).mean()) if len(self.known_novelty) else 0.0
        return accepted, rejected


def fit_calibration(
    evidence: FloatArray,
    novelty: FloatArray,
    truth: IntArray,
    seen: BoolArray | None = None,
    simulated: FloatArray | None = None,
) -> Calibration:
    """Calibrate on held-out clips; without any, the calibration has fixed values.

    seen: (n,) whether the same person at the same task was among the training clips; if not
    given, none was. A known clip that was not seen looks newer than the clips that will be asked
    about. So the threshold and the error rates come from the clips that were seen, where there
    are MIN_USUAL of them; else from `simulated`: (m,) novelties that further takes of the
    recorded cells would have.
    """
    known = truth != NEW
    new, around = novelty[~known], novelty[known]
    judged = novelty[known & seen] if seen is not None else novelty[:0]
    if len(judged) < MIN_USUAL and simulated is not None:
        judged = around = simulated
    if min(len(judged), len(new)) >= MIN_USUAL:
        threshold = _alike(judged, new)
        if judged is not simulated:
            threshold = _in_the_gap(threshold, judged, new)
    else:
        judged = around = novelty[known]
        threshold = _threshold(judged, new)
    return Calibration(
        temperature=_temperature(evidence[known], truth[known]),
        threshold=threshold,
        scale=_scale(around - threshold, new - threshold),
        known_novelty=np.sort(judged),
        new_novelty=np.sort(new),
    )


def softmax(logs: FloatArray) -> FloatArray:
    """(n, k) rows of log weights to shares that sum to 1."""
    shares = np.exp(logs - logs.max(axis=1, keepdims=True, initial=-_FAR))
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


def _alike(known: FloatArray, new: FloatArray) -> float:
    """The novelty that is equally far from the medians of the known and of the new clips, each
    distance in interquartile ranges of its kind.

    Unlike the threshold with the least errors, it does not depend on a few clips at the border.
    Unlike a midpoint of means, it does not depend on one task that is far from all others.
    """
    medians = np.array([float(np.median(part)) for part in (known, new)])
    ranges = np.array([_range(part) for part in (known, new)])
    return float((medians * ranges[::-1]).sum() / ranges.sum())


def _in_the_gap(threshold: float, known: FloatArray, new: FloatArray) -> float:
    """`threshold` moved toward the middle of the gap between known and new clips.

    A wider gap moves it more: a clip in the gap, such as a known task by a new person, is more
    likely to be known.
    """
    highest, lowest = float(np.quantile(known, 1 - TAIL)), float(np.quantile(new, TAIL))
    share = (lowest - highest) / (WIDE_GAP * _range(known))
    return threshold + min(max(share, 0.0), 1.0) * max((lowest + highest) / 2 - threshold, 0.0)


def _range(part: FloatArray) -> float:
    return max(float(np.subtract(*np.quantile(part, [0.75, 0.25]))), 1e-9)


def _scale(known: FloatArray, new: FloatArray) -> float:
    """The scale of the logistic fall-off with the largest likelihood of the held-out clips.

    known, new: their novelties beyond the threshold; both kinds have the same weight.
    """
    if not len(known) or not len(new):
        return 1.0
    loss = [np.logaddexp(0, known / s).mean() + np.logaddexp(0, -new / s).mean() for s in SCALES]
    return float(SCALES[int(np.argmin(loss))])
