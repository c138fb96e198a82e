"""Two motions matched moment by moment: which joints differ, when, and by how much.

The path is the one whose cost is the distance of the search method `dtw`: of the same features,
with the same costs. At each of its steps, the joints of both bodies are compared in the body frame.
There both have their hips at the origin, look ahead, and have the size 1 (body length). So place,
heading and size make no difference, and the hips never differ.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.analysis.descriptors.frame_features import POSITIONS, WARPING_RATE
from app.motion.roles.joint_roles import SUN_ROLES
from app.numerics.alignment.warping_path import warping_path
from app.numerics.arrays import FloatArray, IntArray

MIN_SECONDS_APART = 0.5
"""Peaks of the difference are at least so far apart, in both motions together (mean time)."""


@dataclass(frozen=True, slots=True)
class Alignment:
    """Two motions along their warping path of k steps.

    distance: the mean cost of a step, as the search method `dtw` has it (no unit). times: (k, 2)
    seconds from the start of each motion; both never fall, and their mean grows with each step.
    differences: (k, 13) distances of the joints in SUN_ROLES order, body lengths.
    """

    distance: float
    times: FloatArray
    differences: FloatArray


def align(one: FloatArray, other: FloatArray) -> Alignment:
    """The alignment of two motions by their features at 10 Hz, (n, 82) and (m, 82).

    Features: as of `features_at_10hz`. Raises ValueError for a motion without frames, and
    DeadlineExceeded or ClientLeft (app.deadline).
    """
    path = warping_path(one, other)
    bodies = (_joints(motion)[path.cells[:, side]] for side, motion in enumerate((one, other)))
    differences = np.linalg.norm(np.subtract(*bodies), axis=-1)
    return Alignment(path.cost, path.cells / WARPING_RATE, differences)


def peaks(alignment: Alignment, most: int) -> IntArray:
    """(p,) the steps of greatest mean difference, the greatest first, at most `most`.

    They are at least MIN_SECONDS_APART apart.
    """
    moments, means = alignment.times.mean(axis=1), alignment.differences.mean(axis=1)
    found: list[int] = []
    for step in np.argsort(-means, kind="stable").tolist():
        if len(found) == most:
            break
        if all(abs(moments[step] - moments[peak]) >= MIN_SECONDS_APART for peak in found):
            found.append(step)
    return np.array(found, dtype=np.int64)


def _joints(features: FloatArray) -> FloatArray:
    """(n, 13, 3) the joints in the body frame, body lengths."""
    return features[:, POSITIONS].astype(np.float64).reshape(-1, len(SUN_ROLES), 3)
