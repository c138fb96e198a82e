"""Learns the thresholds T1 and T2 from annotated clips (Perera 2009, sections 3.1 and 3.3).

All pairs of thresholds on a grid are tried. The keyposes hardly depend on them (figs 4 and 5). So
several pairs are about as good as the best. Of these, the pair nearest to the usual thresholds is
used, because a few annotated clips must not move the thresholds to an extreme.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import product
from typing import Any, Protocol

import numpy as np

from app.analysis.keyposes.keyposes import T1, T2
from app.models.keyposes.matching import TOLERANCE, Counts, match
from app.numerics.arrays import FloatArray, IntArray

TRIED_T1 = (0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.5, 0.6, 0.8, 1.0)
TRIED_T2 = (0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 1.0, 1.25, 1.5, 2.0)
"""The grid of thresholds, in units of the median local maximum of an energy."""

MAX_F_LOSS = 0.005
"""Pairs with an F at most this much below the best one count as equally good."""

CURVE_T1 = tuple(np.round(np.arange(0.0, 2.01, 0.1), 2).tolist())
CURVE_T2 = tuple(np.round(np.arange(0.0, 3.01, 0.15), 2).tolist())
"""Thresholds at which precision and recall are computed (figs 4 and 5)."""


class Selectable(Protocol):
    """A motion whose keyposes depend on thresholds, such as `keyposes.Candidates`."""

    def times(self, t1: float, t2: float) -> FloatArray:
        """(k,) times of the keyposes in seconds."""


@dataclass(frozen=True, slots=True)
class Example:
    """An annotated motion; true: (k,) times of its keyposes in seconds."""

    candidates: Selectable
    true: FloatArray


@dataclass(frozen=True, slots=True)
class Thresholds:
    """Thresholds of energy: a minimum below t1 is small, a drop of more than t2 is deep."""

    t1: float
    t2: float


USUAL = Thresholds(T1, T2)


@dataclass(frozen=True, slots=True)
class ThresholdCurve:
    """Precision and recall (v,) by the values (v,) of one threshold; the other one is fixed."""

    values: FloatArray
    precision: FloatArray
    recall: FloatArray


@dataclass(frozen=True, slots=True)
class KeyposeThresholds:
    """The stored model: thresholds by energy method ("rms", "printed")."""

    by_method: dict[str, Thresholds]

    def to_arrays(self) -> tuple[dict[str, FloatArray], dict[str, Any]]:
        """Arrays (none) and JSON, for `from_arrays`."""
        return {}, {name: asdict(pair) for name, pair in self.by_method.items()}

    @classmethod
    def from_arrays(
        cls,
        arrays: Mapping[str, FloatArray],  # noqa: ARG003 - as all models are built
        meta: Mapping[str, Any],
    ) -> KeyposeThresholds:
        """The model from the result of `to_arrays`. Raises KeyError, ValueError."""
        return cls(
            {name: Thresholds(float(pair["t1"]), float(pair["t2"])) for name, pair in meta.items()}
        )


@dataclass(frozen=True, slots=True)
class ThresholdGrid:
    """The results of all pairs of thresholds on the grid for each example.

    counts: (examples, T1, T2, 3) numbers of true, found and correct keyposes.
    """

    counts: IntArray

    def learned(self) -> Thresholds:
        """The thresholds with the best F over the keyposes of all examples.

        Without examples, the usual thresholds.
        """
        return _best(self.counts.sum(axis=0))

    def held_out(self, groups: Sequence[str]) -> tuple[tuple[Thresholds, Counts], ...]:
        """For each example, the thresholds learned from the other groups, and its counts with them.

        groups: (examples,) equal for examples that are held out together.
        """
        names = np.array(groups)
        results = []
        for name, own in zip(groups, self.counts, strict=True):
            pair = _best(self.counts[names != name].sum(axis=0))
            cell = (TRIED_T1.index(pair.t1), TRIED_T2.index(pair.t2))
            results.append((pair, Counts(*(int(count) for count in own[cell]))))
        return tuple(results)


def threshold_grid(examples: Sequence[Example], within: float = TOLERANCE) -> ThresholdGrid:
    """Try all pairs of thresholds. This takes about 50 ms for half a minute of dance.

    within: the largest distance in seconds of a match.
    """
    pairs = list(product(TRIED_T1, TRIED_T2))
    counts = np.array([_counts(example, pairs, within) for example in examples], dtype=np.int64)
    return ThresholdGrid(counts.reshape(len(examples), len(TRIED_T1), len(TRIED_T2), 3))


def curve_of_t1(
    examples: Sequence[Example], t2: float, within: float = TOLERANCE
) -> ThresholdCurve:
    """Fig. 4: T1 varies, T2 is fixed."""
    return _curve([(t1, t2) for t1 in CURVE_T1], CURVE_T1, examples, within)


def curve_of_t2(
    examples: Sequence[Example], t1: float, within: float = TOLERANCE
) -> ThresholdCurve:
    """Fig. 5: T2 varies, T1 is fixed."""
    return _curve([(t1, t2) for t2 in CURVE_T2], CURVE_T2, examples, within)


def _counts(
    example: Example, pairs: Sequence[tuple[float, float]], within: float
) -> list[tuple[int, int, int]]:
    matched = (match(example.candidates.times(*pair), example.true, within) for pair in pairs)
    return [(counts.true, counts.found, counts.correct) for counts in matched]


def _best(counts: IntArray) -> Thresholds:
    """The best thresholds by counts (T1, T2, 3) on the grid."""
    true, found, correct = np.moveaxis(counts, -1, 0)
    f = 2 * correct / np.maximum(true + found, 1)
    t1, t2 = np.meshgrid(TRIED_T1, TRIED_T2, indexing="ij")
    distance = np.abs(np.log(t1 / USUAL.t1)) + np.abs(np.log(t2 / USUAL.t2))
    best = int(np.argmin(np.where(f >= f.max() - MAX_F_LOSS, distance, np.inf)))
    return Thresholds(float(t1.flat[best]), float(t2.flat[best]))


def _curve(
    pairs: Sequence[tuple[float, float]],
    values: Sequence[float],
    examples: Sequence[Example],
    within: float,
) -> ThresholdCurve:
    sums = np.sum([_counts(example, pairs, within) for example in examples], axis=0)
    sums_by_value = [Counts(*(int(count) for count in row)) for row in sums]
    return ThresholdCurve(
        values=np.array(values),
        precision=np.array([counts.precision for counts in sums_by_value]),
        recall=np.array([counts.recall for counts in sums_by_value]),
    )
