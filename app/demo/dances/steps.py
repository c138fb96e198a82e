"""Where a dancer's feet go: one at a time, never crossing, not far from where they began.

Places are in leg lengths on the ground, (x to the left, z ahead); yaw in rad.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from app.demo.controls import Foot
from app.demo.curves import ease
from app.demo.dances.counts import Moment
from app.demo.rig import SIDES, SIGNS
from app.numerics.arrays import FloatArray

STEPPING = 0.8
"""How often a foot is moved from one moment to the next."""

OFTENEST_ALTERNATING = 0.85
WIDTH, AHEAD = (0.2, 0.48), (-0.26, 0.3)
"""Where a foot may be put beside the other one, leg lengths."""

LONGEST = 1.3
"""Leg lengths a second that a foot may go."""

LIFT = 0.16
"""Height of a step, of its length."""

BEARING = 0.3
"""How far the pelvis goes toward the foot that stays, of half the feet's distance."""


@dataclass(frozen=True, slots=True)
class Step:
    """One foot's way from one moment to another: `start`, `end` s; to (x, z, yaw)."""

    side: int
    start: float
    end: float
    to: FloatArray


@dataclass(frozen=True, slots=True)
class Footwork:
    """steps: in time; centers: (moments + 1, 3) x, z, yaw between the feet, the start first."""

    steps: tuple[Step, ...]
    centers: FloatArray


def footwork(
    draw: np.random.RandomState, moments: tuple[Moment, ...], stance: float, turning: float
) -> Footwork:
    """Steps that end shortly before moments.

    stance: half distance of the feet at ease; turning: rad that a step may turn the body.
    """
    feet = np.array([[SIGNS[side] * stance, 0.0, 0.0] for side in SIDES])
    steps: list[Step] = []
    standings, movers = [feet.copy()], []
    left, last = max(moments[0].arrive - 0.6, 0.0), int(draw.randint(2))
    for moment in moments:
        mover = None
        if draw.rand() < STEPPING:
            mover = 1 - last if draw.rand() < OFTENEST_ALTERNATING else last
            start, end = _window(draw, left, moment.arrive)
            feet = feet.copy()
            feet[mover] = _put(draw, feet, mover, turning, LONGEST * (end - start))
            steps.append(Step(mover, start, end, feet[mover].copy()))
            last = mover
        standings.append(feet)
        movers.append(mover)
        left = moment.leave
    return Footwork(tuple(steps), _centers(standings, movers))


def _window(draw: np.random.RandomState, left: float, arrive: float) -> tuple[float, float]:
    end = arrive - draw.uniform(0.0, 0.1) * (arrive - left)
    return end - min(0.85 * (end - left), 0.55), end


def _put(
    draw: np.random.RandomState, feet: FloatArray, mover: int, turning: float, furthest: float
) -> FloatArray:
    """A new place beside the standing foot; of a few, the one nearest to the origin."""
    standing = feet[1 - mover]
    yaw = float(feet[:, 2].mean() + draw.uniform(-turning, turning))
    places = []
    for _ in range(3):
        aside, ahead = SIGNS[mover] * draw.uniform(*WIDTH), draw.uniform(*AHEAD)
        x = standing[0] + aside * np.cos(yaw) + ahead * np.sin(yaw)
        z = standing[1] - aside * np.sin(yaw) + ahead * np.cos(yaw)
        way = np.array([x, z]) - feet[mover, :2]
        share = min(1.0, furthest / max(float(np.linalg.norm(way)), 1e-9))
        places.append(np.array([*(feet[mover, :2] + share * way), yaw]))
    return min(places, key=lambda place: float(np.hypot(place[0], place[1])))


def _centers(standings: list[FloatArray], movers: list[int | None]) -> FloatArray:
    """Between the feet, toward the one that stays when the next step is made."""
    centers = []
    for feet, mover in zip(standings, [*movers, None], strict=True):
        middle = feet.mean(axis=0)
        if mover is not None:
            middle[:2] += BEARING * (feet[1 - mover, :2] - middle[:2])
        centers.append(middle)
    return np.array(centers)


def stepped(times: FloatArray, rest: Foot, side: int, steps: tuple[Step, ...], leg: float) -> Foot:
    """One foot's curves: planted but while it steps; `rest` is where it stands at ease."""
    own = [step for step in steps if step.side == side]
    at = np.array([rest.place[0, 0] / leg, rest.place[0, 2] / leg, 0.0])
    path = np.tile(at, (len(times), 1))
    lift = np.zeros(len(times))
    for step in own:
        done = ease((times - step.start) / (step.end - step.start))
        path += done[:, None] * (step.to - at)
        lift += LIFT * (0.15 + float(np.linalg.norm((step.to - at)[:2]))) * 4 * done * (1 - done)
        at = step.to
    place = np.stack([path[:, 0] * leg, lift * leg, path[:, 1] * leg], axis=-1)
    return replace(rest, place=place, yaw=rest.yaw + path[:, 2])
