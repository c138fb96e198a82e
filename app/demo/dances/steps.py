"""The steps of a dancer: one foot at a time, never crossed, near the starting position.

Positions on the floor are in leg lengths: x to the left, z forward. Yaw is in radians.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from app.demo.controls import Foot
from app.demo.curves import ease
from app.demo.dances.counts import Moment
from app.demo.rig import SIDES, SIGNS
from app.numerics.arrays import FloatArray

STEP_PROBABILITY = 0.8
"""The probability of a step between two poses."""

ALTERNATION_PROBABILITY = 0.85
"""The probability that a step is made by the other foot than the last one."""

WIDTH, AHEAD = (0.2, 0.48), (-0.26, 0.3)
"""The ranges of the position beside and before the standing foot, leg lengths."""

MAX_SPEED = 1.3
"""Leg lengths per second: the largest mean speed of a foot in a step."""

LIFT = 0.16
"""The height of a step, as a share of its length."""

WEIGHT_SHIFT = 0.3
"""The shift of the pelvis toward the standing foot, as a share of its distance."""


@dataclass(frozen=True, slots=True)
class Step:
    """One step of a foot.

    side: its side. start, end: s. to: (3,) x, z and yaw of the new position.
    """

    side: int
    start: float
    end: float
    to: FloatArray


@dataclass(frozen=True, slots=True)
class Footwork:
    """The steps of a dance.

    steps: in order of time. centers: (moments + 1, 3) x, z and yaw of the pelvis on the floor, at
    the start and at each moment.
    """

    steps: tuple[Step, ...]
    centers: FloatArray


def footwork(
    draw: np.random.RandomState, moments: tuple[Moment, ...], stance: float, turning: float
) -> Footwork:
    """Random steps that end at or shortly before the moments.

    stance: half the distance of the feet at the start. turning: the largest turn of the body in one
    step, rad.
    """
    feet = np.array([[SIGNS[side] * stance, 0.0, 0.0] for side in SIDES])
    steps: list[Step] = []
    standings, movers = [feet.copy()], []
    left, last = max(moments[0].arrive - 0.6, 0.0), int(draw.randint(2))
    for moment in moments:
        mover = None
        if draw.rand() < STEP_PROBABILITY:
            mover = 1 - last if draw.rand() < ALTERNATION_PROBABILITY else last
            start, end = _step_times(draw, left, moment.arrive)
            feet = feet.copy()
            feet[mover] = _new_position(draw, feet, mover, turning, MAX_SPEED * (end - start))
            steps.append(Step(mover, start, end, feet[mover].copy()))
            last = mover
        standings.append(feet)
        movers.append(mover)
        left = moment.leave
    return Footwork(tuple(steps), _centers(standings, movers))


def _step_times(draw: np.random.RandomState, left: float, arrive: float) -> tuple[float, float]:
    end = arrive - draw.uniform(0.0, 0.1) * (arrive - left)
    return end - min(0.85 * (end - left), 0.55), end


def _new_position(
    draw: np.random.RandomState,
    feet: FloatArray,
    mover: int,
    turning: float,
    max_distance: float,
) -> FloatArray:
    """(3,) x, z, yaw: a new position beside the standing foot.

    Of three random positions, the one nearest to the origin is used, so that the dancer does not
    leave the stage.
    """
    standing = feet[1 - mover]
    yaw = float(feet[:, 2].mean() + draw.uniform(-turning, turning))
    positions = []
    for _ in range(3):
        aside, ahead = SIGNS[mover] * draw.uniform(*WIDTH), draw.uniform(*AHEAD)
        x = standing[0] + aside * np.cos(yaw) + ahead * np.sin(yaw)
        z = standing[1] - aside * np.sin(yaw) + ahead * np.cos(yaw)
        way = np.array([x, z]) - feet[mover, :2]
        share = min(1.0, max_distance / max(float(np.linalg.norm(way)), 1e-9))
        positions.append(np.array([*(feet[mover, :2] + share * way), yaw]))
    return min(positions, key=lambda position: float(np.hypot(position[0], position[1])))


def _centers(standings: list[FloatArray], movers: list[int | None]) -> FloatArray:
    """(moments + 1, 3) x, z, yaw between the feet, shifted to the foot that stands next."""
    centers = []
    for feet, mover in zip(standings, [*movers, None], strict=True):
        middle = feet.mean(axis=0)
        if mover is not None:
            middle[:2] += WEIGHT_SHIFT * (feet[1 - mover, :2] - middle[:2])
        centers.append(middle)
    return np.array(centers)


def foot_curves(
    times: FloatArray, rest: Foot, side: int, steps: tuple[Step, ...], leg: float
) -> Foot:
    """The curves of the foot `side`, which moves only in its steps.

    times: (frames,) s. rest: the foot in the resting posture. leg: its length, m.
    """
    own = [step for step in steps if step.side == side]
    at = np.array([rest.position[0, 0] / leg, rest.position[0, 2] / leg, 0.0])
    path = np.tile(at, (len(times), 1))
    lift = np.zeros(len(times))
    for step in own:
        done = ease((times - step.start) / (step.end - step.start))
        path += done[:, None] * (step.to - at)
        lift += LIFT * (0.15 + float(np.linalg.norm((step.to - at)[:2]))) * 4 * done * (1 - done)
        at = step.to
    position = np.stack([path[:, 0] * leg, lift * leg, path[:, 1] * leg], axis=-1)
    return replace(rest, position=position, yaw=rest.yaw + path[:, 2])
