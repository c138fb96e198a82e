"""Matching: one to one, as many pairs as there can be."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import linear_sum_assignment

from app.models.keyposes.matching import Counts, match, total

TIMES = st.lists(st.floats(0, 3), max_size=12)


@given(TIMES, TIMES, st.floats(0.01, 0.5))
def test_the_number_of_pairs_is_the_largest_possible(
    found: list[float], true: list[float], within: float
) -> None:
    """A slow twin: the best assignment of all."""
    near = np.abs(np.subtract.outer(found, true)) <= within
    rows, columns = linear_sum_assignment(-near.astype(float))
    counts = match(np.array(found), np.array(true), within)
    assert counts.correct == int(near[rows, columns].sum())
    assert (counts.found, counts.true) == (len(found), len(true))


def test_two_detections_of_one_keypose_count_once() -> None:
    counts = match(np.array([1.0, 1.05]), np.array([1.02]))
    assert counts == Counts(true=1, found=2, correct=1)
    assert (counts.precision, counts.recall) == (0.5, 1.0)
    assert counts.f == pytest.approx(2 / 3)


def test_clips_without_keyposes() -> None:
    none = np.zeros(0)
    assert match(none, none).f == 1.0
    assert match(none, np.array([1.0])).f == 0.0
    assert (match(none, none).precision, match(none, none).recall) == (0.0, 0.0)


def test_counts_add_up() -> None:
    assert total([Counts(3, 2, 1), Counts(5, 6, 4)]) == Counts(8, 8, 5)
    assert total([]) == Counts(0, 0, 0)
