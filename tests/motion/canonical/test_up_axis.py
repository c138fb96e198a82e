"""Up is where heads are, unless the rest pose knows better."""

from __future__ import annotations

import numpy as np
import pytest

from app.motion.canonical.up_axis import judge_up_axis, to_y_up
from app.numerics.arrays import FloatArray
from tests.people import ROLES, person

EXPECTED = {role: index for index, role in enumerate(ROLES)}
STANDING = person().positions
# Turns that bring Y to the axis named; all proper rotations.
FROM_Y = {
    "y": np.eye(3),
    "z": np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]),
    "x": np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1]]),
    "-y": np.diag([1, -1, -1]),
    "-z": np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]),
    "-x": np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]]),
}


def turned(axis: str) -> FloatArray:
    return np.asarray(STANDING @ FROM_Y[axis].T)


@pytest.mark.parametrize("axis", sorted(FROM_Y))
def test_a_standing_body_tells_its_axis_and_is_turned_upright(axis: str) -> None:
    positions = turned(axis)
    found = judge_up_axis(positions, positions[0], EXPECTED, "y")
    assert found == axis
    assert np.allclose(to_y_up(positions, found), STANDING, atol=1e-6)


def test_who_lies_down_stays_lying() -> None:
    lying = turned("z")
    assert judge_up_axis(lying, STANDING[0], EXPECTED, "y") == "y"


def test_without_feet_or_size_the_declared_axis_stands() -> None:
    assert judge_up_axis(STANDING, STANDING[0], {}, "z") == "z"
    assert judge_up_axis(0 * STANDING, 0 * STANDING[0], EXPECTED, "y") == "y"
