"""Joint angles over the gait cycle: 0 % is a foot strike, 100 % the next strike of that foot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.analysis.angles.angles import JointAngles
from app.analysis.angles.definitions import ANGLE_NAMES
from app.analysis.gait.strides import Stride
from app.motion.skeleton.resampling import sample_at
from app.numerics.arrays import FloatArray

POINTS = 101
"""The points of a cycle: 0, 1, ..., 100 percent."""

_ROTATIONS = ("pelvis_rotation_deg", "thorax_rotation_deg")
"""Angles about the vertical. In a cycle they are relative to the direction of the stride."""


@dataclass(frozen=True, slots=True)
class MeanCycle:
    """The mean cycle of one side.

    names: (k,) angles without the side. mean, sd: (POINTS, k) degrees over `strides` strides; the
    sample standard deviation (divisor strides - 1) is NaN for one stride.
    """

    side: str
    strides: int
    names: tuple[str, ...]
    mean: FloatArray
    sd: FloatArray


def mean_cycles(angles: JointAngles, strides: Sequence[Stride]) -> list[MeanCycle]:
    """The mean cycles of the sides that have strides, the left one first."""
    sides = ("left", "right")
    by_side = {side: [stride for stride in strides if stride.side == side] for side in sides}
    return [_mean_cycle(angles, side, mine) for side, mine in by_side.items() if mine]


def _mean_cycle(angles: JointAngles, side: str, strides: Sequence[Stride]) -> MeanCycle:
    own = f"{side}_"
    names = [n for n in ANGLE_NAMES if n.startswith(own) or not n.startswith(("left_", "right_"))]
    columns = [ANGLE_NAMES.index(name) for name in names]
    cycles = np.stack([_cycle(angles, stride, columns, names) for stride in strides])
    alone = len(strides) == 1
    return MeanCycle(
        side=side,
        strides=len(strides),
        names=tuple(name.removeprefix(own) for name in names),
        mean=cycles.mean(axis=0),
        sd=np.full(cycles.shape[1:], np.nan) if alone else cycles.std(axis=0, ddof=1),
    )


def _cycle(
    angles: JointAngles, stride: Stride, columns: Sequence[int], names: Sequence[str]
) -> FloatArray:
    """(POINTS, k) degrees at equal times from strike to strike."""
    times = np.linspace(stride.strike, stride.next_strike, POINTS)
    cycle = sample_at(angles.degrees[:, columns], times * angles.frame_rate)
    for name in _ROTATIONS:
        if name in names:
            column = names.index(name)
            turned = cycle[:, column] - np.degrees(stride.heading)
            # whole turns of the person do not matter
            cycle[:, column] = turned - 360.0 * np.round(np.mean(turned) / 360.0)
    return np.asarray(cycle)
