"""The poses of a dance: arms, hips, trunk and head, drawn around some that people strike.

A pose is one row of CHANNELS; a dance is a matrix of rows and their weights over time.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
from scipy.interpolate import make_interp_spline

from app.demo.controls import Arm
from app.demo.dances.counts import Moment
from app.demo.keys import ArmPose
from app.numerics.arrays import FloatArray

ARMS: tuple[ArmPose, ...] = (
    ArmPose(1.15, 0.0, 0.75, 1.0),
    ArmPose(0.2, 1.5, 0.0, 0.2),
    ArmPose(0.55, -0.1, 0.9, 0.95),
    ArmPose(2.5, 0.25, 0.0, 0.3),
    ArmPose(-0.5, 0.75, 0.9, 1.75),
    ArmPose(0.3, 2.25, 0.0, 0.12),
    ArmPose(-0.1, 0.65, 0.2, 0.2),
    ArmPose(1.5, 1.5, 0.0, 1.5),
    ArmPose(0.35, 0.5, 0.5, 2.1),
    ArmPose(1.5, 0.1, 0.0, 0.15),
    ArmPose(0.9, 0.7, 0.2, 0.5),
    ArmPose(2.0, 0.6, 0.0, 1.3),
    ArmPose(-0.6, 0.3, 0.1, 0.35),
)
"""Arms before, aside, crossed, up, akimbo, pointing, low, like goals, folded, ahead, ..."""

CHANNELS = 18
LEFT_ARM, RIGHT_ARM = slice(0, 5), slice(5, 10)
HIPS, TRUNK = slice(10, 13), slice(13, 16)
HEAD, CROUCH = 16, 17
"""flex, abduct, twist, elbow, wrist of each arm; yaw, pitch, roll of hips and of trunk; yaw of
the head; lowering of the pelvis in leg lengths."""

SYMMETRIC = 0.4
JITTER = 0.12
"""rad (standard deviation), so that no pose is struck twice alike."""

HIGHEST_FLEX, HIGHEST_ABDUCT = 2.9, 2.5
FULL_MOVE = 0.5
"""Seconds. A pose with less time is danced smaller."""

LOOSE = 0.02
"""Seconds (standard deviation) by which parts of the body arrive and leave apart."""

SHORTEST = 0.02
"""Seconds for which a part rests at least."""


def draw_poses(
    draw: np.random.RandomState, moments: tuple[Moment, ...], rest: Arm, size: float
) -> FloatArray:
    """(moments + 1, CHANNELS): the pose at ease, then one for each moment.

    size: factor on how far poses are from ease.
    """
    ease = np.zeros(CHANNELS)
    for side in (LEFT_ARM, RIGHT_ARM):
        ease[side] = [float(getattr(rest, name)[0]) for name in Arm.__dataclass_fields__]
    poses: list[FloatArray] = [ease]
    arms, left = (-1, -1), moments[0].arrive - FULL_MOVE
    for moment in moments:
        arms = _other_arms(draw, arms)
        wanted = ease + size * (_figure(draw, arms) - ease)
        share = np.clip((moment.arrive - left) / FULL_MOVE, 0.45, 1.0)
        poses.append(_possible(poses[-1] + share * (wanted - poses[-1])))
        left = moment.leave
    return np.array(poses)


def _other_arms(draw: np.random.RandomState, before: tuple[int, int]) -> tuple[int, int]:
    """Poses of both arms, at least one of them another than before."""
    while True:
        left = int(draw.randint(len(ARMS)))
        right = left if draw.rand() < SYMMETRIC else int(draw.randint(len(ARMS)))
        if left != before[0] and right != before[1]:
            return left, right


def _figure(draw: np.random.RandomState, arms: tuple[int, int]) -> FloatArray:
    row = np.zeros(CHANNELS)
    for side, index in zip((LEFT_ARM, RIGHT_ARM), arms, strict=True):
        pose = ARMS[index]
        row[side] = [pose.flex, pose.abduct, pose.twist, pose.elbow, pose.wrist]
        row[side] += JITTER * draw.randn(5)
    row[HIPS] = draw.uniform([-0.25, -0.05, -0.1], [0.25, 0.15, 0.1])
    row[TRUNK] = draw.uniform([-0.35, -0.1, -0.2], [0.35, 0.3, 0.2])
    row[HEAD] = draw.uniform(-0.5, 0.5)
    row[CROUCH] = draw.uniform(0.01, 0.15)
    return row


def _possible(row: FloatArray) -> FloatArray:
    for side in (LEFT_ARM, RIGHT_ARM):
        lowest = [-0.9, -0.15, -0.5, 0.05, -0.4]
        highest = [HIGHEST_FLEX, HIGHEST_ABDUCT, 1.2, 2.2, 0.7]
        row[side] = np.clip(row[side], lowest, highest)
    return row


def weights(times: FloatArray, moments: tuple[Moment, ...]) -> FloatArray:
    """(frames, moments + 1) share of each pose, summing to 1; the first one is at ease.

    Between two held poses the course of least jerk, through the poses that are passed
    (Flash & Hogan 1985: quintic between via points, smooth in four derivatives).
    """
    shares = np.zeros((len(times), len(moments) + 1))
    shares[times < moments[0].arrive, 0] = 1.0
    held = [0, *(k + 1 for k, moment in enumerate(moments) if moment.is_held)]
    for before, after in pairwise(held):
        end = moments[after - 1]
        start = moments[before - 1].leave if before else end.arrive - FULL_MOVE
        passed = [moments[k - 1].arrive for k in range(before + 1, after)]
        during = (times >= start) & (times < end.arrive)
        course = _course(np.array([start, *passed, end.arrive]))
        shares[during] = 0.0
        shares[during, before : after + 1] = course(times[during])
        rest = (times >= end.arrive) & (times < end.leave)
        shares[rest, after] = 1.0
    shares[times >= moments[held[-1] - 1].leave, held[-1]] = 1.0
    return shares


def loosened(
    moments: tuple[Moment, ...], draw: np.random.RandomState, lag: float
) -> tuple[Moment, ...]:
    """The moments of one part of the body: `lag` s later, and never quite together with others."""
    found = []
    for moment in moments:
        late, longer = lag + np.clip(LOOSE * draw.randn(2), -2 * LOOSE, 2 * LOOSE)
        leave = max(moment.leave + longer, moment.arrive + late + SHORTEST)
        if not moment.is_held:
            leave = moment.leave + late
        found.append(replace(moment, arrive=moment.arrive + late, leave=leave))
    return tuple(found)


def _course(knots: FloatArray) -> Callable[[FloatArray], FloatArray]:
    """(t,) -> (t, knots): the weight of each knot's pose, at rest at both ends."""
    at_rest = [(1, np.zeros(len(knots))), (2, np.zeros(len(knots)))]
    course: Callable[[FloatArray], FloatArray] = make_interp_spline(
        knots, np.eye(len(knots)), k=5, bc_type=(at_rest, at_rest)
    )
    return course
