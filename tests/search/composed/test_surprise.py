"""Parts of a query together: surprises and their weighted mean."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.search.composed.surprise import CERTAINTY, Part, costs, mean_surprise, surprise

PROBABILITY = st.floats(0.0, 1.0)
KINDS = st.sampled_from(["pooled", "for", "against"])
PARTS = st.lists(st.tuples(st.floats(0.01, 100.0), KINDS, PROBABILITY), min_size=1, max_size=6)
Parts = list[tuple[float, str, float]]


def _twin(parts: Parts) -> float:
    """The formula of the docstring, one part after the other."""
    total = sum(weight for weight, *_ in parts)
    kept = [
        (weight, kind, min(max(likely, CERTAINTY), 1.0 - CERTAINTY))
        for weight, kind, likely in parts
    ]
    odds, pooled, found = 0.0, 0.0, 0.0
    for weight, kind, likely in kept:
        if kind == "pooled":
            odds += weight * math.log(likely / (1.0 - likely))
            pooled += weight
        else:
            found -= weight * math.log(likely if kind == "for" else 1.0 - likely)
    if pooled:
        found += pooled * math.log(1.0 + math.exp(-odds / pooled))
    return found / total


def _mean(parts: Parts) -> float:
    given = [
        Part(weight, is_against=kind == "against", is_pooled=kind == "pooled")
        for weight, kind, _ in parts
    ]
    return float(mean_surprise(given, [np.array([likely]) for *_, likely in parts])[0])


@given(PARTS)
def test_it_is_the_mean_of_the_surprises(parts: Parts) -> None:
    assert _mean(parts) == pytest.approx(_twin(parts), rel=1e-4, abs=1e-9)


@given(PARTS, st.floats(0.1, 10.0))
def test_only_the_proportion_of_weights_counts(parts: Parts, factor: float) -> None:
    scaled = [(factor * weight, kind, likely) for weight, kind, likely in parts]
    assert _mean(scaled) == pytest.approx(_mean(parts))


@given(PARTS, PROBABILITY, PROBABILITY)
def test_more_of_what_is_wanted_never_makes_a_clip_worse(
    parts: Parts, one: float, other: float
) -> None:
    low, high = sorted((one, other))
    slack = 1e-9  # of rounding
    for kind in ("pooled", "for"):
        assert _mean([*parts, (1.0, kind, high)]) <= _mean([*parts, (1.0, kind, low)]) + slack
    against = _mean([*parts, (1.0, "against", high)])
    assert against >= _mean([*parts, (1.0, "against", low)]) - slack


@pytest.mark.parametrize("is_against", [False, True])
def test_certainty_is_finite(is_against: bool) -> None:
    found = surprise(np.array([0.0, 0.5, 1.0]), is_against=is_against)
    assert np.isfinite(found).all()
    assert (found >= 0).all()
    assert found[1] == pytest.approx(math.log(2))


@given(PARTS)
def test_costs_are_no_less_than_0_and_sum_to_the_mean_surprise(parts: Parts) -> None:
    made = [
        Part(weight, is_against=kind == "against", is_pooled=kind == "pooled")
        for weight, kind, _ in parts
    ]
    found = costs(made, [likely for *_, likely in parts])
    assert min(found) >= 0
    assert sum(found) == pytest.approx(_twin(parts), rel=1e-6, abs=1e-9)
