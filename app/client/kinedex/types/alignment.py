"""Answers: alignment. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass

from kinedex.records import Array, Record
from kinedex.types.choices import JointRole


@dataclass(frozen=True, slots=True)
class Peak(Record):
    """A moment at which the two motions differ much.

    times: Seconds from the start of the first and the second clip.
    difference: Mean over the joints, meters.
    joint: The joint that differs most.
    joint_difference: Meters.
    """

    times: list[float]
    difference: float
    joint: JointRole
    joint_difference: float


@dataclass(frozen=True, slots=True, eq=False)
class Alignment(Record):
    """Two clips along their warping path: steps, joints, and how far the joints are apart.

    distance: Mean cost of a step. A search with `method=dtw` has the same distance.
    body_lengths: Meters: torso, neck to head, and shin. Both bodies are scaled to the mean of
    these two lengths before their joints are compared.
    path: (steps, 2): seconds from the start of the first and of the second clip. Neither ever
    falls.
    joints: The 13 joints of figure 2 in Sun 2011.
    differences: (steps, joints), meters: distance of the joint of one body from the same joint
    of the other, with the hips of both at one place and both turned the same way.
    mean_differences: (joints,) mean over the steps, meters.
    peaks: Moments of greatest mean difference, at least 0.5 s apart, greatest first.
    """

    distance: float
    body_lengths: list[float]
    path: Array
    joints: list[JointRole]
    differences: Array
    mean_differences: Array
    peaks: list[Peak]
