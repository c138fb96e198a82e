from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.numerics.area_under_curve import area_under_curve
from app.numerics.arrays import FloatArray

FEW_VALUES = st.lists(st.sampled_from([-np.inf, -1.0, 0.0, 0.5, 2.0]), min_size=1, max_size=12)


def pair_by_pair(positives: FloatArray, negatives: FloatArray) -> float:
    wins = [(p > n) + 0.5 * (p == n) for p in positives for n in negatives]
    return float(np.mean(wins))


@given(FEW_VALUES, FEW_VALUES)
def test_it_counts_pairs_and_ties_by_half(positives: list[float], negatives: list[float]) -> None:
    own, others = np.array(positives), np.array(negatives)
    assert area_under_curve(own, others) == pytest.approx(pair_by_pair(own, others))


def test_the_ends_of_the_scale() -> None:
    low, high = np.array([0.0, 1.0]), np.array([2.0, 3.0, 4.0])
    assert area_under_curve(high, low) == 1.0
    assert area_under_curve(low, high) == 0.0


def test_without_one_kind_the_area_is_one_half() -> None:
    assert area_under_curve(np.zeros(0), np.ones(3)) == 0.5
    assert area_under_curve(np.ones(3), np.zeros(0)) == 0.5
