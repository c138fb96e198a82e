"""The poses of a dance: random variations of typical poses of arms, hips, trunk and head.

A pose is a row of CHANNELS numbers. A dance is a matrix of such rows, and their weights over time.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
from scipy.interpolate import make_interp_spline

from app.demo.controls import Arm
from app.demo.curves import quintic_curve
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
"""Typical poses of an arm: before the chest, aside, crossed, up, on the hip, pointing, low, ..."""

CHANNELS = 18
LEFT_ARM, RIGHT_ARM = slice(0, 5), slice(5, 10)
HIPS, TRUNK = slice(10, 13), slice(13, 16)
HEAD, CROUCH = 16, 17
"""The columns: flex, abduct, twist, elbow, wrist of each arm; yaw, pitch, roll of hips and of the
trunk; yaw of the head; lowering of the pelvis in leg lengths."""

SYMMETRY_PROBABILITY = 0.4
"""The probability that both arms take the same pose."""

VARIATION = 0.12
"""Radians (standard deviation) by which poses vary, so that no pose occurs twice."""

MAX_FLEX, MAX_ABDUCT = 2.9, 2.5
"""Radians."""

FULL_MOVE = 0.5
"""Seconds. With less time, the body moves only a part of the way to the pose."""

PART_DELAY = 0.02
"""Seconds (standard deviation) of random delays between parts of the body."""

MIN_REST = 0.02
"""Seconds: the shortest rest of a part."""


SPEED_FACTOR = (0.4, 1.6)
"""The range of the factor between the speed of a part of the body and that of its moment."""


def draw_poses(
    draw: np.random.RandomState, moments: tuple[Moment, ...], rest: Arm, size: float
) -> FloatArray:
    """(moments + 1, CHANNELS) the resting pose, then one pose for each moment.

    rest: the resting pose of an arm. size: factor on the difference of poses from the resting pose.
    """
    ease = np.zeros(CHANNELS)
    for side in (LEFT_ARM, RIGHT_ARM):
        ease[side] = [float(getattr(rest, name)[0]) for name in Arm.__dataclass_fields__]
    poses: list[FloatArray] = [ease]
    arms, left = (-1, -1), moments[0].arrive - FULL_MOVE
    for moment in moments:
        arms = _other_arms(draw, arms)
        target = ease + size * (_random_pose(draw, arms) - ease)
        share = np.clip((moment.arrive - left) / FULL_MOVE, 0.45, 1.0)
        poses.append(_within_limits(poses[-1] + share * (target - poses[-1])))
        left = moment.leave
    return np.array(poses)


def _other_arms(draw: np.random.RandomState, before: tuple[int, int]) -> tuple[int, int]:
    """The indices of the poses of both arms; each arm changes its pose."""
    while True:
        left = int(draw.randint(len(ARMS)))
        right = left if draw.rand() < SYMMETRY_PROBABILITY else int(draw.randint(len(ARMS)))
        if left != before[0] and right != before[1]:
            return left, right


def _random_pose(draw: np.random.RandomState, arms: tuple[int, int]) -> FloatArray:
    row = np.zeros(CHANNELS)
    for side, index in zip((LEFT_ARM, RIGHT_ARM), arms, strict=True):
        pose = ARMS[index]
        row[side] = [pose.flex, pose.abduct, pose.twist, pose.elbow, pose.wrist]
        row[side] += VARIATION * draw.randn(5)
    row[HIPS] = draw.uniform([-0.25, -0.05, -0.1], [0.25, 0.15, 0.1])
    row[TRUNK] = draw.uniform([-0.35, -0.1, -0.2], [0.35, 0.3, 0.2])
    row[HEAD] = draw.uniform(-0.5, 0.5)
    row[CROUCH] = draw.uniform(0.01, 0.15)
    return row


def _within_limits(row: FloatArray) -> FloatArray:
    """`row` (CHANNELS,) with the arms limited to angles that a body can reach. Changes `row`."""
    for side in (LEFT_ARM, RIGHT_ARM):
        lowest = [-0.9, -0.15, -0.5, 0.05, -0.4]
        highest = [MAX_FLEX, MAX_ABDUCT, 1.2, 2.2, 0.7]
        row[side] = np.clip(row[side], lowest, highest)
    return row


def weights(times: FloatArray, moments: tuple[Moment, ...]) -> FloatArray:
    """(frames, moments + 1) the weight of each pose at `times` (frames,) s; weights sum to 1.

    The first pose is the resting pose. Between two stops, the weights follow the curve of least
    jerk through the other poses (Flash & Hogan 1985: quintic pieces that are smooth in four
    derivatives). Its time is warped, so that the body is slow at soft keyposes.
    """
    shares = np.zeros((len(times), len(moments) + 1))
    shares[times < moments[0].arrive, 0] = 1.0
    stops = [0, *(k + 1 for k, moment in enumerate(moments) if moment.is_stop)]
    for before, after in pairwise(stops):
        end, between = moments[after - 1], moments[before : after - 1]
        start = moments[before - 1].leave if before else end.arrive - FULL_MOVE
        course = _course(np.array([start, *(passed.time for passed in between), end.arrive]))
        during = (times >= start) & (times < end.arrive)
        warped = _warped(times[during], start, between, end.arrive)
        shares[during] = 0.0
        shares[during, before : after + 1] = course(warped)
        rest = (times >= end.arrive) & (times < end.leave)
        shares[rest, after] = 1.0
    shares[times >= moments[stops[-1] - 1].leave, stops[-1]] = 1.0
    return shares


def _warped(times: FloatArray, start: float, moments: tuple[Moment, ...], end: float) -> FloatArray:
    """(t,) `times` (t,) in seconds, made slow at the soft keyposes among `moments`.

    The time of each moment stays. start, end: of the movement, s.
    """
    passed = [(m.time, m.time, m.speed if m.is_held else 1.0, 0.0) for m in moments]
    return quintic_curve(times, [(start, start, 1.0, 0.0), *passed, (end, end, 1.0, 0.0)])


def with_part_lag(
    moments: tuple[Moment, ...], draw: np.random.RandomState, lag: float
) -> tuple[Moment, ...]:
    """The moments of one part of the body: `lag` seconds later, plus small random delays."""
    delayed = []
    for moment in moments:
        late, longer = lag + np.clip(PART_DELAY * draw.randn(2), -2 * PART_DELAY, 2 * PART_DELAY)
        leave = max(moment.leave + longer, moment.arrive + late + MIN_REST)
        if not moment.is_held:
            leave = moment.leave + late
        # Arms, trunk and hips do not slow down alike.
        speed = moment.speed * draw.uniform(*SPEED_FACTOR) if moment.speed else 0.0
        delayed.append(
            replace(
                moment,
                arrive=moment.arrive + late,
                time=moment.time + late,
                leave=leave,
                speed=speed,
            )
        )
    return tuple(delayed)


def _course(knots: FloatArray) -> Callable[[FloatArray], FloatArray]:
    """A function from times (t,) to the weights (t, knots) of the poses at `knots`, in seconds.

    Velocity and acceleration are 0 at both ends.
    """
    at_rest = [(1, np.zeros(len(knots))), (2, np.zeros(len(knots)))]
    course: Callable[[FloatArray], FloatArray] = make_interp_spline(
        knots, np.eye(len(knots)), k=5, bc_type=(at_rest, at_rest)
    )
    return course
