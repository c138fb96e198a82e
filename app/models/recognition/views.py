"""The two views of a clip in the default recognizer, and their log densities.

A full sample (1762,) is the motion sample (1250,) followed by the wide motion vector (512,). The
motion sample has 32 poses at known phases. The wide motion vector does not depend on the time in
the clip at which a hand waves. The views overlap: the last two numbers of the sample, turn and
speed, belong to both.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, NamedTuple

import numpy as np

from app.analysis.descriptors.motion_sample import SAMPLE_LENGTH
from app.models.recognition.calibration import NEW
from app.models.recognition.hypotheses import Hypotheses
from app.models.recognition.kinds import Disturbed
from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.numerics.log_sums import log_sum, log_sums
from app.numerics.principal_axes import PrincipalAxes

SAMPLE_DIMENSIONS = 80
"""Number of PCA coordinates of motion samples."""

MIN_WIDTH, MAX_WIDTH = 20, 60
"""Bounds of the number of PCA coordinates of wide motion vectors."""

FREEDOM = 50.0
"""Degrees of freedom of the densities that rank labels: a single outlier must not decide."""

TURN_AND_SPEED = 2
"""Numbers at the end of a motion sample that belong to both views."""


def wide_dimensions(cells: int) -> int:
    """The number of PCA coordinates of wide motion vectors for `cells` cells: half as many.

    The differences between persons, or tasks, are learned from cells. With too many coordinates
    for the cells, new clips are called known. In libraries of 35 cells drawn from dataset 2, .79
    of the new tasks were recognized as new with 60 coordinates, and .97 with 20.
    """
    return min(max(cells // 2, MIN_WIDTH), MAX_WIDTH)


def full_samples(samples: FloatArray, wide: FloatArray) -> FloatArray:
    """(n, 1762) of motion samples (n, 1250) and wide motion vectors (n, 512)."""
    return np.hstack([samples, wide])


@dataclass(frozen=True, slots=True)
class View:
    """One view of clips: PCA coordinates, and the hypotheses in these coordinates."""

    axes: PrincipalAxes
    hypotheses: Hypotheses

    def to_arrays(self, name: str) -> dict[str, np.ndarray[Any, Any]]:
        """Arrays, their names beginning with `name`."""
        arrays = {"centre": self.axes.center, "axes": self.axes.axes}
        arrays |= {f.name: getattr(self.hypotheses, f.name) for f in fields(Hypotheses)}
        return {f"{name}_{key}": array for key, array in arrays.items()}

    @classmethod
    def from_arrays(cls, name: str, arrays: Mapping[str, Any]) -> View:
        """The view from the result of `to_arrays`."""
        axes = PrincipalAxes(arrays[f"{name}_centre"], arrays[f"{name}_axes"])
        parts = {f.name: arrays[f"{name}_{f.name}"] for f in fields(Hypotheses)}
        return cls(axes, Hypotheses(**parts))


class BothViews(NamedTuple):
    """The same n clips in both views: (n, numbers or coordinates) each."""

    sample: FloatArray
    wide: FloatArray

    def of(self, index: IntArray) -> BothViews:
        """The rows of the clips at these indices."""
        return BothViews(self.sample[index], self.wide[index])


def both_views(samples: FloatArray, sample_length: int = SAMPLE_LENGTH) -> BothViews:
    """Split full samples (n, 1762) into motion samples of `sample_length` and wide vectors.

    If no wide vectors follow the motion samples, both views are the motion samples.
    """
    rows = np.asarray(samples)
    sample = rows[:, :sample_length]
    if rows.shape[1] <= sample_length:
        return BothViews(sample, sample)
    return BothViews(sample, rows[:, sample_length - TURN_AND_SPEED :])


class LogDensities(NamedTuple):
    """Log densities (n, h) of n clips under h hypotheses.

    `ranking` ranks labels; the other two decide whether the person and the task are new.
    """

    ranking: FloatArray
    new_person: FloatArray
    new_task: FloatArray

    @staticmethod
    def ranking_under(sample: Hypotheses, wide: Hypotheses, points: BothViews) -> FloatArray:
        """Only the `ranking` (n, h), which costs a third."""
        by_sample = sample.log_likelihoods(points.sample, FREEDOM)
        return np.asarray((by_sample + wide.log_likelihoods(points.wide, FREEDOM)) / 2)

    @classmethod
    def under(
        cls, sample: Hypotheses, wide: Hypotheses, points: BothViews, *, persons_by_both: bool
    ) -> LogDensities:
        """The log densities of both views.

        The mean of both (Student's t) ranks labels; the wide view (Gaussian) decides what is
        new, without the hypotheses that a clip is cut: a piece of a new task resembles a piece of a
        known one. persons_by_both: both views decide whether a person is new. This is better if few
        takes are repeated. Else the sample view only adds noise, since takes of one task differ
        much in it.
        """
        of_sample, of_wide = sample.squares(points.sample), wide.squares(points.wide)
        by_sample = sample.log_densities(of_sample, FREEDOM)
        by_wide = wide.log_densities(of_wide, FREEDOM)
        person = task = wide.log_densities(of_wide)
        if persons_by_both:
            person = (sample.log_densities(of_sample) + task) / 2
        is_whole = wide.disturbed != Disturbed.CUT
        person, task = (np.where(is_whole, logs, -np.inf) for logs in (person, task))
        return cls((by_sample + by_wide) / 2, person, task)

    def of(self, index: BoolArray) -> LogDensities:
        """The rows of the clips where `index` (n,) is true."""
        return LogDensities(*(logs[index] for logs in self))

    def without_others(
        self, label: IntArray, names: tuple[str, ...], known: str | None
    ) -> LogDensities:
        """Exclude the hypotheses with another label than `known`.

        label: (h,) index in `names`, -1 for new.
        """
        if known is None:
            return self
        index = names.index(known) if known in names else NEW
        stays = (label == index) | (label == NEW)
        return LogDensities(*(np.where(stays, logs, -np.inf) for logs in self))


def evidence(ranking: FloatArray, label: IntArray, labels: int) -> FloatArray:
    """(n, labels) log of the sum of the densities of each label's hypotheses.

    ranking: (n, h) log densities; label: (h,), -1 for new. Each label occurs at least once.
    """
    order = np.argsort(label, kind="stable")
    order = order[label[order] >= 0]
    starts = np.searchsorted(label[order], np.arange(labels))
    return log_sums(ranking[:, order], starts)


def newness(logs: FloatArray, label: IntArray) -> FloatArray:
    """(n,) log evidence of a new label minus the log evidence of a known one.

    logs: (n, h); label: (h,), -1 for new.
    """
    new = label < 0
    return np.asarray(log_sum(logs[:, new]) - log_sum(logs[:, ~new]))
