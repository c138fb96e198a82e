"""The axis from the feet to the head is up, unless the rest pose agrees with the file."""

from __future__ import annotations

import numpy as np
import pytest

from app.motion.canonical.up_axis import judge_up_axis, to_y_up
from app.numerics.arrays import FloatArray
from tests.people import ROLES, person

EXPECTED = {role: index for index, role in enumerate(ROLES)}
STANDING = person().positions
# Rotations from Y to each axis. None is a mirror.
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
def test_the_axis_of_a_standing_body_is_found_and_turned_up(axis: str) -> None:
    positions = turned(axis)
    found = judge_up_axis(positions, positions[0], EXPECTED, "y")
    assert found == axis
    assert np.allclose(to_y_up(positions, found), STANDING, atol=1e-6)


def test_a_lying_body_stays_lying() -> None:
    lying = turned("z")
    assert judge_up_axis(lying, STANDING[0], EXPECTED, "y") == "y"


def test_the_declared_axis_is_used_without_feet_or_size() -> None:
    assert judge_up_axis(STANDING, STANDING[0], {}, "z") == "z"
    assert judge_up_axis(0 * STANDING, 0 * STANDING[0], EXPECTED, "y") == "y"
