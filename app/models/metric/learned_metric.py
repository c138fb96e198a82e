"""Learned metrics: the similarity of two clips in task, or in person, from the library's labels.

Linear discriminants (app.numerics.discriminant) of three descriptors of a clip: its motion
vector, its motion sample (one gait cycle, or the whole) and its symbol statistics. Coordinates
are normalized to unit length, so that their Euclidean distance, 0 to 2, ranks like their cosine.
Directions that do not separate the labels of the fit have a small weight. Without it, clips of
other tasks would all be near one point.
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
"""Names of the descriptors, in the order in which `ClipDescriptors` has them."""

DIMENSIONS = 160
"""Number of principal axes of the descriptors, before the discriminants; 100 to 250 do as well."""

COORDINATES = 64
"""Number of coordinates of a clip."""

UNSEPARATED_WEIGHT = 0.05
"""Added to the variance between labels along each axis, in units of the variance within labels."""

MIN_LABELS = 2
"""Number of labels with at least two clips each that a metric needs."""

MAX_CLIPS = 5000
"""Largest number of labeled clips in a fit, drawn with a fixed seed; more change it very little. It
bounds the memory: a clip takes 12 kB, some times over."""

AT_ONCE = 2000
"""Clips whose coordinates are computed at once. It bounds the memory."""

_MIN_DIVISOR = 1e-9
"""Avoids divisions by 0."""


class Factor(StrEnum):
    """The label that a metric is learned from."""

    TASK = "task"
    PERSON = "person"


WEIGHTS = {Factor.TASK: (1.0, 1.0, 0.5), Factor.PERSON: (1.0, 0.5, 1.0)}
"""Weights of motion vector, motion sample and symbol statistics, after scaling each to the same
total variance.

The poses of a cycle identify tasks, also of unseen persons; statistics of angles, heights and
speeds identify persons, also in unseen tasks. The weights and the numbers above were chosen on
dataset 1, CMU's clips and two takes of dataset 2; `tests/bench/test_learned_metrics.py` measures
on the other three takes.
"""


@dataclass(frozen=True, slots=True)
class ClipDescriptors:
    """The descriptors of n clips from which metrics are learned.

    vectors: (n, 128) motion vectors; samples: (n, 1250) motion samples; statistics: (n, 131)
    symbol statistics. Other widths are possible.
    """

    vectors: FloatArray
    samples: FloatArray
    statistics: FloatArray

    def __len__(self) -> int:
        return len(self.vectors)

    def part(self, index: IntArray) -> ClipDescriptors:
        """The descriptors of the clips at these indices."""
        return ClipDescriptors(self.vectors[index], self.samples[index], self.statistics[index])

    def widths(self) -> tuple[int, ...]:
        """The width of each descriptor."""
        return tuple(getattr(self, f.name).shape[1] for f in fields(self))

    def concatenated(self) -> FloatArray:
        """(n, d) float64: all descriptors in one row for each clip.

        Statistics are transformed by asinh, since some (such as speeds) have heavy tails.
        """
        compressed = np.arcsinh(np.asarray(self.statistics, dtype=np.float64))
        return np.hstack([self.vectors, self.samples, compressed]).astype(np.float64)


@dataclass(frozen=True, slots=True)
class MetricAxes:
    """The map from descriptors to coordinates.

    center: (d,) mean of `ClipDescriptors.concatenated`; axes: (d, k).
    """

    center: FloatArray
    axes: FloatArray

    def project(self, described: ClipDescriptors) -> FloatArray:
        """(n, k) coordinates of unit length (0 for a clip at the center)."""
        places = np.arange(len(described))
        blocks = [
            (described.part(places[first : first + AT_ONCE]).concatenated() - self.center)
            @ self.axes
            for first in range(0, len(described), AT_ONCE)
        ]
        points = np.concatenate([np.zeros((0, self.axes.shape[1])), *blocks])
        lengths = np.linalg.norm(points, axis=1, keepdims=True)
        return np.asarray(points / np.maximum(lengths, _MIN_DIVISOR))


@dataclass(frozen=True, slots=True)
class LearnedMetric:
    """A metric, and the calibration of its distances."""

    axes: MetricAxes
    calibration: PairCalibration

    def to_arrays(self) -> tuple[dict[str, Any], dict[str, Any]]:
        """Arrays and JSON-able metadata for `from_arrays`."""
        meta = {"level": self.calibration.level, "slope": self.calibration.slope}
        arrays = {"centre": self.axes.center, "axes": self.axes.axes.astype(np.float32)}
        return arrays, {"version": METRIC_VERSION, **meta}

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, Any], meta: Mapping[str, Any]) -> LearnedMetric:
        """The metric from the result of `to_arrays`. Raises ValueError on another version."""
        if meta["version"] != METRIC_VERSION:
            raise ValueError(f"learned metric of version {meta['version']}")
        calibration = PairCalibration(float(meta["level"]), float(meta["slope"]))
        return cls(MetricAxes(arrays["centre"], arrays["axes"]), calibration)


def fit_axes(
    described: ClipDescriptors, labels: Sequence[str | None], factor: Factor
) -> MetricAxes:
    """Learn from n clips with their labels (n,), None for no label.

    Raises NotEnoughLabels if `check_labels` does.
    """
    check_labels(labels, factor)
    labeled = _drawn([i for i, label in enumerate(labels) if label])
    part = described.part(labeled)
    rows = part.concatenated()
    center = rows.mean(axis=0)
    rows -= center
    scales = _scales(rows, part.widths(), factor)
    principal = principal_axes(rows * scales, DIMENSIONS, centered=False)
    _, classes = np.unique([str(labels[i]) for i in labeled], return_inverse=True)
    separating = discriminants(principal.project(rows * scales), classes, COORDINATES)
    # the share of the variance along an axis that lies between labels
    between = separating.between + UNSEPARATED_WEIGHT
    weights = np.sqrt(between / (1.0 + between))
    # one map (d, k) for scaling, principal axes, discriminants and weights
    axes = scales[:, None] * (principal.axes @ (separating.axes * weights))
    return MetricAxes(center, axes)


def check_labels(labels: Sequence[str | None], factor: Factor) -> None:
    """Raise NotEnoughLabels if fewer than MIN_LABELS labels have two clips."""
    counts = Counter(label for label in labels if label)
    several = sum(count > 1 for count in counts.values())
    if several < MIN_LABELS:
        raise NotEnoughLabels(
            f"A metric needs {MIN_LABELS} {factor}s with two clips each to learn how {factor}s "
            f"differ; {several} of {len(counts)} {factor}s have two."
        )


def _drawn(labeled: list[int]) -> IntArray:
    """At most MAX_CLIPS of the indices `labeled`, ascending."""
    if len(labeled) <= MAX_CLIPS:
        return np.array(labeled)
    return np.sort(np.random.RandomState(0).permutation(labeled)[:MAX_CLIPS])


def _scales(centered: FloatArray, widths: tuple[int, ...], factor: Factor) -> FloatArray:
    """(d,) factors that give the descriptors in `centered` (n, d) their weights.

    The columns of the statistics have different units, so each is first divided by its standard
    deviation. Columns that hardly vary get a smaller factor, since they are mostly noise.
    """
    deviation = np.sqrt((centered**2).mean(axis=0))
    ends = np.cumsum((0, *widths))
    scales = np.ones(len(deviation))
    last = slice(ends[-2], ends[-1])
    scales[last] = 1.0 / (deviation[last] + max(0.1 * np.median(deviation[last]), _MIN_DIVISOR))
    for weight, first, stop in zip(WEIGHTS[factor], ends[:-1], ends[1:], strict=True):
        total = np.linalg.norm(deviation[first:stop] * scales[first:stop])
        scales[first:stop] *= weight / max(float(total), _MIN_DIVISOR)
    return scales
