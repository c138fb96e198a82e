from __future__ import annotations

import numpy as np
import pytest

from app.analysis.descriptors.motion_shape import SHAPE_LENGTH, mirrored
from app.models.synthesis.sides import likely_side, sides, to_side
from app.numerics.arrays import FloatArray


def takes(count: int, *, seed: int = 0, noise: float = 0.05) -> FloatArray:
    """(count, 1378) takes of one motion that is not its own mirror image."""
    rng = np.random.default_rng(seed)
    shapes = rng.normal(size=SHAPE_LENGTH) + noise * rng.normal(size=(count, SHAPE_LENGTH))
    shapes[:, -2:] = [1.0, 0.0]
    return np.asarray(shapes)


def turned(shapes: FloatArray, which: list[int]) -> FloatArray:
    out = shapes.copy()
    out[which] = mirrored(out[which])
    return out


@pytest.mark.parametrize("left", [[0], [1, 3], [0, 1, 2, 4]])
def test_takes_of_two_sides_are_separated(left: list[int]) -> None:
    found = sides(turned(takes(5), left))
    few = -1 if len(left) < 3 else 1
    np.testing.assert_array_equal(found, [few if i in left else -few for i in range(5)])


def test_of_equally_frequent_sides_that_of_the_first_take_is_positive() -> None:
    np.testing.assert_array_equal(sides(turned(takes(4), [0, 3])), [1, -1, -1, 1])


def test_takes_of_one_side_have_no_side() -> None:
    assert not sides(takes(6)).any()
    assert not sides(takes(6, noise=1.0)).any()
    assert not sides(takes(1)).any()
    symmetric = takes(6)
    assert not sides((symmetric + mirrored(symmetric)) / 2 + 0.01 * takes(6, seed=3)).any()


def test_cycles_have_no_side() -> None:
    cyclic = turned(takes(4), [1])
    cyclic[2, -1] = 1.0
    assert not sides(cyclic).any()


def test_takes_are_mirrored_to_one_side_and_back() -> None:
    plain = takes(5)
    mixed = turned(plain, [1, 3])
    found = sides(mixed)
    np.testing.assert_allclose(to_side(mixed, found, 1), plain)
    np.testing.assert_allclose(to_side(mixed, found, -1), mirrored(plain))
    np.testing.assert_allclose(to_side(plain, np.ones_like(found), found), mixed)
    np.testing.assert_array_equal(to_side(mixed, np.zeros_like(found), 1), mixed)


def test_the_side_of_a_task_follows_the_correlation_among_others() -> None:
    kicks, waves = np.array([1, 1, -1, 1]), np.array([-1, -1, 1, -1])
    assert likely_side([-1], [kicks], waves) == 1
    assert likely_side([1], [kicks], waves) == -1
    assert likely_side([0], [kicks], waves) == -1  # as most do
    assert likely_side([], [], waves) == -1
    assert likely_side([-1], [np.zeros(4, dtype=np.int64)], waves) == -1
    assert likely_side([1], [kicks], np.zeros(4, dtype=np.int64)) == 1
