"""Parts of a query together: surprises and their weighted mean."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.search.composed.surprise import CERTAINTY, Part, mean_surprise, surprise

PROBABILITY = st.floats(0.0, 1.0)
PARTS = st.lists(
    st.tuples(st.floats(0.01, 100.0), st.booleans(), PROBABILITY), min_size=1, max_size=6
)


def _twin(parts: list[tuple[float, bool, float]]) -> float:
    """The formula of the docstring, one part after the other."""
    total, product = 0.0, 0.0
    for weight, is_against, likely in parts:
        kept = min(max(likely, CERTAINTY), 1.0 - CERTAINTY)
        product -= weight * math.log(1.0 - kept if is_against else kept)
        total += weight
    return product / total


def _mean(parts: list[tuple[float, bool, float]]) -> float:
    given = [Part(weight, is_against) for weight, is_against, _ in parts]
    return float(mean_surprise(given, [np.array([likely]) for *_, likely in parts])[0])


@given(PARTS)
def test_it_is_the_mean_of_the_surprises(parts: list[tuple[float, bool, float]]) -> None:
    assert _mean(parts) == pytest.approx(_twin(parts), rel=1e-4, abs=1e-9)


@given(PARTS, st.floats(0.1, 10.0))
def test_only_the_proportion_of_weights_counts(
    parts: list[tuple[float, bool, float]], factor: float
) -> None:
    scaled = [(factor * weight, is_against, likely) for weight, is_against, likely in parts]
    assert _mean(scaled) == pytest.approx(_mean(parts))


@given(PARTS, PROBABILITY, PROBABILITY)
def test_more_of_what_is_wanted_never_makes_a_clip_worse(
    parts: list[tuple[float, bool, float]], one: float, other: float
) -> None:
    low, high = sorted((one, other))
    assert _mean([*parts, (1.0, False, high)]) <= _mean([*parts, (1.0, False, low)])
    assert _mean([*parts, (1.0, True, high)]) >= _mean([*parts, (1.0, True, low)])


@pytest.mark.parametrize("is_against", [False, True])
def test_certainty_is_finite(is_against: bool) -> None:
    found = surprise(np.array([0.0, 0.5, 1.0]), is_against=is_against)
    assert np.isfinite(found).all()
    assert (found >= 0).all()
    assert found[1] == pytest.approx(math.log(2))
