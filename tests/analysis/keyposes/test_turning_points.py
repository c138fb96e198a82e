"""The far ends of movements that return: found in strikes, not in movements to another pose."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from app.analysis.keyposes.candidates import Scope
from app.analysis.keyposes.keyposes import find_keyposes
from app.analysis.keyposes.turning_points import MAX_RETURN, MIN_REACH, turning_points
from app.motion.frame.body_frame import body_track
from app.motion.motion import Motion
from app.motion.roles.joint_roles import JointRole
from app.numerics.arrays import FloatArray
from tests.bodies import motion_of, move_joint, standing

RATE = 60.0
TIMES = np.arange(int(6 * RATE)) / RATE


def strike(far: float, *, width: float = 0.25) -> FloatArray:
    """(frames,) 0 to 1 and back to 0, 1 at the time `far` in seconds."""
    return np.asarray(np.exp(-0.5 * np.square((TIMES - far) / width)))


def kicks(*far: float, returned: bool = True) -> Motion:
    """A body that kicks forward with its right foot at the times `far`, s; its arms swing later."""
    curve = np.sum([strike(time) for time in far], axis=0)
    if not returned:
        curve = np.maximum(curve, far[-1] <= TIMES)
    body = standing(len(TIMES))
    for role, reach in ((JointRole.RIGHT_FOOT, 0.9), (JointRole.RIGHT_KNEE, 0.5)):
        move_joint(body, role, curve[:, None] * [0.0, 0.6 * reach, reach])
    swing = np.sum([strike(time + 0.3) for time in far], axis=0)[:, None]
    move_joint(body, JointRole.LEFT_HAND, swing * [0.0, 0.2, -0.4])
    move_joint(body, JointRole.RIGHT_HAND, swing * [0.0, 0.2, 0.4])
    body += 0.002 * np.random.default_rng(1).normal(size=body.shape)
    return motion_of(body, RATE)


def slow_turning_points(poses: FloatArray, bounds: list[int]) -> list[int]:
    """The twin of `turning_points`: every pair of poses one after the other."""

    def distance(one: int, other: int) -> float:
        squares = [
            float(((a - b) ** 2).sum()) for a, b in zip(poses[one], poses[other], strict=True)
        ]
        return float(np.sqrt(np.mean(squares)))

    found = []
    for left, right in pairwise(bounds):
        away = {k: min(distance(k, left), distance(k, right)) for k in range(left, right + 1)}
        far = max(away, key=lambda k: away[k])
        if away[far] >= MIN_REACH and distance(left, right) <= MAX_RETURN * away[far]:
            found.append(far)
    return found


@pytest.mark.parametrize("seed", range(4))
def test_the_fast_way_equals_the_slow_one(seed: int) -> None:
    rng = np.random.default_rng(seed)
    poses = np.cumsum(0.02 * rng.normal(size=(90, 13, 3)), axis=0)
    poses += 0.3 * np.sin(np.arange(90) / 6)[:, None, None] * rng.normal(size=(13, 3))
    bounds = [0, 19, 38, 57, 89]
    assert turning_points(poses, bounds) == slow_turning_points(poses, bounds)
    assert turning_points(poses, [0, 1]) == turning_points(poses, [5]) == []


def test_the_far_end_of_each_kick_is_a_keypose() -> None:
    found = find_keyposes(body_track(kicks(1.5, 4.2)))
    turns = [t for t, by in zip(found.times, found.chosen_by, strict=True) if by is Scope.TURN]
    assert turns == pytest.approx([1.5, 4.2], abs=0.1)
    assert np.all(np.diff(found.frames) > 0)


def test_a_leg_that_stays_up_does_not_turn() -> None:
    found = find_keyposes(body_track(kicks(3.0, returned=False)))
    assert Scope.TURN not in found.chosen_by


def test_known_beats_leave_no_room_for_turning_points() -> None:
    found = find_keyposes(body_track(kicks(1.5, 4.2)), beats=np.array([0.3, 3.0, 5.5]))
    assert Scope.TURN not in found.chosen_by


def test_a_still_body_has_no_turning_point() -> None:
    assert len(find_keyposes(body_track(motion_of(standing(120)))).frames) == 0
