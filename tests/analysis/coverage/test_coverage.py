"""Seconds by speed, turn and direction, of paths whose speeds and turns are known."""

from __future__ import annotations

import numpy as np
import pytest

from app.analysis.coverage.coverage import DIRECTIONS, SPEED_EDGES, TURN_EDGES, coverage_of
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray

RATE = 30.0


def walker(speed: float, turn: float, seconds: float, facing: float = 0.0) -> FloatArray:
    """(n, 13, 3) a body that moves at a speed (m/s) and turns (deg/s to the left).

    facing: degrees by which the body faces to the left of where it goes.
    """
    times = np.arange(round(seconds * RATE)) / RATE
    course = np.radians(turn) * times
    step = speed / RATE
    place = (
        np.cumsum(np.stack([np.sin(course), np.zeros_like(course), np.cos(course)], 1), 0) * step
    )
    heading = course + np.radians(facing)
    left = np.stack([np.cos(heading), np.zeros_like(heading), -np.sin(heading)], axis=1)
    positions = np.repeat(place[:, None], len(SUN_ROLES), axis=1)
    for side, sign in (("left", 0.2), ("right", -0.2)):
        positions[:, SUN_ROLES.index(JointRole(f"{side}_shoulder"))] += sign * left
    return positions


@pytest.mark.parametrize("speed", [0.05, 0.7, 1.2, 2.5, 6.0])
@pytest.mark.parametrize("turn", [-200.0, -60.0, 0.0, 45.0, 120.0])
def test_a_steady_path_is_in_one_cell(speed: float, turn: float) -> None:
    seconds = 4.0
    found = coverage_of(walker(speed, turn, seconds))
    row = max(i for i, edge in enumerate(SPEED_EDGES) if edge <= speed)
    column = sum(edge <= turn for edge in TURN_EDGES)
    assert found.seconds == pytest.approx(seconds)
    # a turn shortens the mean of a velocity over half a second a little
    assert found.cells[max(row - 1, 0) : row + 1, column].sum() > 0.9 * seconds
    mirrored = found.mirrored()
    assert np.array_equal(mirrored.cells[:, len(TURN_EDGES) - column], found.cells[:, column])


@pytest.mark.parametrize(
    ("facing", "direction"), [(0, "forward"), (90, "right"), (180, "backward"), (-90, "left")]
)
def test_the_direction_is_relative_to_where_the_body_faces(facing: float, direction: str) -> None:
    found = coverage_of(walker(1.0, 0.0, 3.0, facing))
    assert found.directions[DIRECTIONS.index(direction)] == pytest.approx(3.0)


def test_who_stands_goes_in_no_direction() -> None:
    found = coverage_of(walker(0.0, 0.0, 2.0))
    assert found.directions.sum() == 0
    assert found.cells[0].sum() == pytest.approx(2.0)


def test_sums_are_sums_and_one_frame_is_nothing() -> None:
    one, other = coverage_of(walker(1.0, 0.0, 2.0)), coverage_of(walker(1.0, 90.0, 1.0))
    assert (one + other).seconds == pytest.approx(3.0)
    assert coverage_of(walker(1.0, 0.0, 1.0)[:1]).seconds == 0
