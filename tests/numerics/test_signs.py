from __future__ import annotations

import numpy as np

from app.numerics.signs import column_signs, fix_signs


def test_the_largest_entry_of_each_column_becomes_positive() -> None:
    columns = np.array([[1.0, -3.0, 0.0], [-2.0, 1.0, 0.0]])
    np.testing.assert_array_equal(fix_signs(columns), [[-1.0, 3.0, 0.0], [2.0, -1.0, 0.0]])


def test_a_vector_and_its_negative_give_the_same() -> None:
    columns = np.random.default_rng(0).normal(size=(7, 5))
    np.testing.assert_array_equal(fix_signs(columns), fix_signs(-columns))


def test_rounding_does_not_decide_between_equal_magnitudes() -> None:
    pair = np.array([[1.0], [-1.0]])
    nudged = np.array([[1.0], [-1.0 - 1e-14]])
    np.testing.assert_array_equal(column_signs(pair), column_signs(nudged))


def test_no_rows_have_signs_too() -> None:
    np.testing.assert_array_equal(column_signs(np.zeros((0, 2))), [1.0, 1.0])
