"""The two ways in which the default recognizer looks at a clip, and what hypotheses say of both.

A full sample (1762,) is the motion sample (1250,), whose 32 poses are of known phases, followed
by the wide motion vector (512,), to which it is all one when a hand waves. The views overlap:
the sample's last two numbers, turn and speed, belong to both.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, NamedTuple

import numpy as np

from app.analysis.descriptors.motion_sample import SAMPLE_LENGTH
from app.models.recognition.calibration import NEW
from app.models.recognition.hypotheses import Hypotheses
from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.numerics.principal_axes import PrincipalAxes

SAMPLE_DIMENSIONS = 80
"""PCA coordinates of motion samples."""

MIN_WIDTH, MAX_WIDTH = 20, 60
"""PCA coordinates of wide motion vectors."""

FREEDOM = 50.0
"""Degrees of freedom of the densities that rank labels: one strange number should not decide."""

TURN_AND_SPEED = 2
"""Numbers at the end of a motion sample that both views have."""


def wide_dimensions(cells: int) -> int:
    """PCA coordinates of wide motion vectors for so many cells: half as many.

    What two persons, or two tasks, differ in is learned from cells; in more coordinates than
    they can tell of, what is new looked known (of libraries of 35 cells drawn from dataset 2,
    in 60 coordinates .79 of new tasks were told, in 20 .97).
    """
    return min(max(cells // 2, MIN_WIDTH), MAX_WIDTH)


def full_samples(samples: FloatArray, wide: FloatArray) -> FloatArray:
    """(n, 1762) of motion samples (n, 1250) and wide motion vectors (n, 512)."""
    return np.hstack([samples, wide])


@dataclass(frozen=True, slots=True)
class View:
    """One way of looking at clips: coordinates, and the hypotheses among them."""

    axes: PrincipalAxes
    hypotheses: Hypotheses

    def to_arrays(self, name: str) -> dict[str, np.ndarray[Any, Any]]:
        """Arrays, their names beginning with `name`."""
        arrays = {"centre": self.axes.centre, "axes": self.axes.axes}
        arrays |= {f.name: getattr(self.hypotheses, f.name) for f in fields(Hypotheses)}
        return {f"{name}_{key}": array for key, array in arrays.items()}

    @classmethod
    def from_arrays(cls, name: str, arrays: Mapping[str, Any]) -> View:
        """What to_arrays took apart."""
        axes = PrincipalAxes(arrays[f"{name}_centre"], arrays[f"{name}_axes"])
        parts = {f.name: arrays[f"{name}_{f.name}"] for f in fields(Hypotheses)}
        return cls(axes, Hypotheses(**parts))


class Seen(NamedTuple):
    """The same n clips as both views have them: (n, numbers or coordinates)."""

    sample: FloatArray
    wide: FloatArray

    def of(self, index: IntArray) -> Seen:
        """Of the clips at these indices."""
        return Seen(self.sample[index], self.wide[index])


def both_views(samples: FloatArray, sample_length: int = SAMPLE_LENGTH) -> Seen:
    """Full samples (n, 1762), whose motion samples are of `sample_length`, taken apart.

    Where no wide vector follows the motion samples they are both views.
    """
    rows = np.asarray(samples)
    sample = rows[:, :sample_length]
    if rows.shape[1] <= sample_length:
        return Seen(sample, sample)
    return Seen(sample, rows[:, sample_length - TURN_AND_SPEED :])


class Logs(NamedTuple):
    """Log densities (n, h) of n clips under the same hypotheses: by `ranking` labels are ranked;
    by the others is told whether the person, and whether the task, is new."""

    ranking: FloatArray
    new_person: FloatArray
    new_task: FloatArray

    @classmethod
    def under(
        cls, sample: Hypotheses, wide: Hypotheses, points: Seen, *, persons_by_both: bool
    ) -> Logs:
        """Ranking by the mean of both views, Student's; what is new by the wide one, Gaussian.

        persons_by_both: where takes are hardly repeated, persons are told by both views. Where
        they are, the samples' view only disturbs, since takes of one task differ much in it.
        """
        of_sample, of_wide = sample.squares(points.sample), wide.squares(points.wide)
        by_sample = sample.log_densities(of_sample, FREEDOM)
        by_wide = wide.log_densities(of_wide, FREEDOM)
        person = task = wide.log_densities(of_wide)
        if persons_by_both:
            person = (sample.log_densities(of_sample) + task) / 2
        return cls((by_sample + by_wide) / 2, person, task)

    def of(self, index: BoolArray) -> Logs:
        """Of some clips."""
        return Logs(*(logs[index] for logs in self))

    def without_others(self, label: IntArray, names: tuple[str, ...], known: str | None) -> Logs:
        """Without the hypotheses that name another label than the known one.

        label: (h,) index among `names`, -1 for new.
        """
        if known is None:
            return self
        index = names.index(known) if known in names else NEW
        left = (label == index) | (label == NEW)
        return Logs(*(np.where(left, logs, -np.inf) for logs in self))


def evidence(ranking: FloatArray, label: IntArray, labels: int) -> FloatArray:
    """(n, labels) log of the summed densities of the hypotheses naming each label.

    ranking: (n, h) log densities; label: (h,), -1 for new. Each label is named at least once.
    """
    order = np.argsort(label, kind="stable")
    order = order[label[order] >= 0]
    starts = np.searchsorted(label[order], np.arange(labels))
    return np.asarray(np.logaddexp.reduceat(ranking[:, order], starts, axis=1))


def newness(logs: FloatArray, label: IntArray) -> FloatArray:
    """(n,) log evidence that the label is a new one, less that it is a known one.

    logs: (n, h); label: (h,), -1 for new.
    """
    new = label < 0
    said_new = np.logaddexp.reduce(logs[:, new], axis=1)
    return np.asarray(said_new - np.logaddexp.reduce(logs[:, ~new], axis=1))
