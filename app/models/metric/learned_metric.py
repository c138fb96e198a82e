"""Learned metrics: how near two clips are in task, or in person, by the library's own labels.

Linear discriminants (app.numerics.discriminant) of three descriptors of a clip: its motion
vector, its motion sample (one gait cycle, or the whole) and its symbol statistics. Coordinates
are brought to unit length, so that their Euclidean distance, 0 to 2, ranks as their cosine does.
Directions that part none of the known labels keep a small weight: tasks that nobody has
labeled yet must not fall together.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from enum import StrEnum
from typing import Any

import numpy as np

from app.errors import NotEnoughLabels
from app.models.metric.pair_calibration import PairCalibration
from app.numerics.arrays import FloatArray, IntArray
from app.numerics.discriminant import discriminants
from app.numerics.principal_axes import principal_axes

METRIC_VERSION = 1

INPUTS = ("motion_vector", "motion_sample", "symbol_statistics")
"""Names of the descriptors, in the order in which `Described` has them."""

DIMENSIONS = 160
"""Principal axes of the descriptors, in which labels are parted; 100 to 250 do alike."""

COORDINATES = 64
"""Kept of a clip."""

UNPARTED = 0.05
"""Weight of a direction that parts no labels, as a variance beside that within a label."""

MIN_LABELS = 2
"""Labels with at least two clips each that a metric needs."""

MAX_CLIPS = 20_000
"""Labeled clips that are fitted on, drawn by a fixed seed; more would hardly move it."""

_SMALLEST = 1e-9


class Factor(StrEnum):
    """The label that a metric is learned from."""

    TASK = "task"
    PERSON = "person"


WEIGHTS = {Factor.TASK: (1.0, 1.0, 0.5), Factor.PERSON: (1.0, 0.5, 1.0)}
"""Of motion vector, motion sample and symbol statistics, each brought to one total variance.

Poses through a cycle tell tasks, also of a person never seen; statistics of angles, heights
and speeds tell persons, also in a task never seen. Chosen, like the numbers above, on dataset
1, CMU's clips and two takes of dataset 2; `tests/bench/test_learned_metrics.py` measures on
the other three.
"""


@dataclass(frozen=True, slots=True)
class Described:
    """The descriptors of n clips that metrics look at.

    vectors: (n, 128) motion vectors; samples: (n, 1250) motion samples; statistics: (n, 131)
    symbol statistics. Other widths are taken too.
    """

    vectors: FloatArray
    samples: FloatArray
    statistics: FloatArray

    def __len__(self) -> int:
        return len(self.vectors)

    def part(self, index: IntArray) -> Described:
        """The clips of these numbers."""
        return Described(self.vectors[index], self.samples[index], self.statistics[index])

    def widths(self) -> tuple[int, ...]:
        """Numbers of each descriptor."""
        return tuple(getattr(self, f.name).shape[1] for f in fields(self))

    def beside(self) -> FloatArray:
        """(n, d) float64: all descriptors beside each other.

        Statistics come as their asinh: some have heavy tails, as speeds have.
        """
        tamed = np.arcsinh(np.asarray(self.statistics, dtype=np.float64))
        return np.hstack([self.vectors, self.samples, tamed]).astype(np.float64)


@dataclass(frozen=True, slots=True)
class MetricAxes:
    """From descriptors to coordinates. center: (d,) of `Described.beside`; axes: (d, k)."""

    center: FloatArray
    axes: FloatArray

    def project(self, described: Described) -> FloatArray:
        """(n, k) coordinates, of unit length (0 where a clip is the very center)."""
        points = (described.beside() - self.center) @ self.axes
        lengths = np.linalg.norm(points, axis=1, keepdims=True)
        return np.asarray(points / np.maximum(lengths, _SMALLEST))


@dataclass(frozen=True, slots=True)
class LearnedMetric:
    """A metric with what its distances mean."""

    axes: MetricAxes
    calibration: PairCalibration

    def to_arrays(self) -> tuple[dict[str, Any], dict[str, Any]]:
        """Arrays and JSON-able meta from which from_arrays makes the same record."""
        meta = {"level": self.calibration.level, "slope": self.calibration.slope}
        arrays = {"centre": self.axes.center, "axes": self.axes.axes.astype(np.float32)}
        return arrays, {"version": METRIC_VERSION, **meta}

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, Any], meta: Mapping[str, Any]) -> LearnedMetric:
        """The record that to_arrays took apart. Raises ValueError on another version."""
        if meta["version"] != METRIC_VERSION:
            raise ValueError(f"learned metric of version {meta['version']}")
        calibration = PairCalibration(float(meta["level"]), float(meta["slope"]))
        return cls(MetricAxes(arrays["centre"], arrays["axes"]), calibration)


def fit_axes(described: Described, labels: Sequence[str | None], factor: Factor) -> MetricAxes:
    """Learn from n clips with their labels (n,), None where there is none.

    Raises NotEnoughLabels.
    """
    check_labels(labels, factor)
    known = _drawn([i for i, label in enumerate(labels) if label])
    part = described.part(known)
    rows = part.beside()
    center = rows.mean(axis=0)
    rows -= center
    scales = _scales(rows, part.widths(), factor)
    found = principal_axes(rows * scales, DIMENSIONS, centred=False)
    _, classes = np.unique([str(labels[i]) for i in known], return_inverse=True)
    parted = discriminants(found.project(rows * scales), classes, COORDINATES)
    strength = parted.between + UNPARTED
    weights = np.sqrt(strength / (1.0 + strength))
    return MetricAxes(center, scales[:, None] * (found.axes @ (parted.axes * weights)))


def check_labels(labels: Sequence[str | None], factor: Factor) -> None:
    """Raise NotEnoughLabels where no metric can be learned from `labels`."""
    counts = Counter(label for label in labels if label)
    several = sum(count > 1 for count in counts.values())
    if several < MIN_LABELS:
        raise NotEnoughLabels(
            f"It takes {MIN_LABELS} {factor}s with two clips each to learn what tells "
            f"{factor}s apart; {several} of {len(counts)} {factor}s have two."
        )


def _drawn(known: list[int]) -> IntArray:
    if len(known) <= MAX_CLIPS:
        return np.array(known)
    return np.sort(np.random.RandomState(0).permutation(known)[:MAX_CLIPS])


def _scales(centred: FloatArray, widths: tuple[int, ...], factor: Factor) -> FloatArray:
    """(d,) factors that bring the descriptors in `centred` (n, d) to their weights.

    The last one's columns are of many units: they are brought to about one deviation first,
    those that hardly vary to less, since they hold mostly noise.
    """
    deviation = np.sqrt((centred**2).mean(axis=0))
    ends = np.cumsum((0, *widths))
    scales = np.ones(len(deviation))
    last = slice(ends[-2], ends[-1])
    scales[last] = 1.0 / (deviation[last] + max(0.1 * np.median(deviation[last]), _SMALLEST))
    for weight, first, stop in zip(WEIGHTS[factor], ends[:-1], ends[1:], strict=True):
        total = np.linalg.norm(deviation[first:stop] * scales[first:stop])
        scales[first:stop] *= weight / max(float(total), _SMALLEST)
    return scales
