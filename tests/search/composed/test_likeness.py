"""Probabilities of distances, and the typical distance of a library."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.search.composed.likeness import CURVES, SMALLEST, Curve, even_sample, typical_distance
from app.search.example.methods import Method

DISTANCE = st.floats(0.0, 1e9)


@pytest.mark.parametrize("method", CURVES)
@given(one=DISTANCE, other=DISTANCE, typical=st.floats(SMALLEST, 1e6))
def test_a_farther_clip_is_never_more_likely(
    method: Method, one: float, other: float, typical: float
) -> None:
    found = CURVES[method].probabilities(np.array([0.0, *sorted((one, other)), np.inf]), typical)
    assert found[0] == 1.0
    assert found[-1] == 0.0
    assert (np.diff(found) <= 0).all()


@given(st.floats(1e-3, 1e3), st.floats(1e-3, 1e3))
def test_the_unit_of_distances_does_not_matter(distance: float, unit: float) -> None:
    curve = CURVES[Method.VECTOR]
    own = curve.probabilities(np.array([distance]), 1.0)
    assert curve.probabilities(np.array([unit * distance]), unit) == pytest.approx(own)


def test_half_is_at_the_ratio() -> None:
    assert Curve(0.4, 5.0).probabilities(np.array([0.8]), 2.0) == pytest.approx([0.5])


def test_the_typical_distance_leaves_deleted_clips_out_and_is_above_zero() -> None:
    assert typical_distance(np.array([1.0, np.inf, 3.0, 2.0])) == 2.0
    assert typical_distance(np.zeros(5)) == SMALLEST
    assert typical_distance(np.zeros(0)) == 1.0


@given(st.integers(0, 3000), st.integers(1, 100))
def test_a_sample_is_even(size: int, count: int) -> None:
    found = even_sample(np.arange(size), count)
    assert len(found) == min(size, count)
    if len(found) > 1:
        steps = np.diff(found)
        assert steps.min() >= 1
        assert steps.max() - steps.min() <= 1
        assert (found[0], found[-1]) == (0, size - 1)
