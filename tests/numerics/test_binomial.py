"""Votes: intervals and the exact test, held against scipy's."""

from __future__ import annotations

import pytest
from scipy.stats import binomtest

from app.numerics.binomial import fair_coin_probability, wilson_interval

VOTES = [(0, 1), (1, 1), (0, 7), (5, 7), (17, 34), (29, 34), (32, 34), (34, 34), (92, 102)]


@pytest.mark.parametrize(("successes", "trials"), VOTES)
def test_both_agree_with_scipy(successes: int, trials: int) -> None:
    twin = binomtest(successes, trials)
    expected = twin.proportion_ci(method="wilson")
    assert wilson_interval(successes, trials) == pytest.approx((expected.low, expected.high))
    assert fair_coin_probability(successes, trials) == pytest.approx(twin.pvalue)


def test_the_paper_s_table_2_is_no_chance() -> None:
    low, high = wilson_interval(92, 102)
    assert low < 0.9 < high
    assert low > 0.8
    assert fair_coin_probability(92, 102) < 1e-15


def test_no_votes_say_nothing() -> None:
    assert wilson_interval(0, 0) == (0.0, 1.0)
    assert fair_coin_probability(0, 0) == 1.0


@pytest.mark.parametrize("count", [wilson_interval, fair_coin_probability])
def test_more_votes_than_voters_are_refused(count: object) -> None:
    with pytest.raises(ValueError, match="expected 0 to 2 successes, found 3"):
        count(3, 2)  # type: ignore[operator]
    with pytest.raises(ValueError, match="found -1"):
        count(-1, 2)  # type: ignore[operator]


def test_thousands_of_votes_are_no_trouble() -> None:
    assert 0 <= fair_coin_probability(4_000, 10_000) < 1e-80
    low, high = wilson_interval(4_000, 10_000)
    assert 0.39 < low < 0.4 < high < 0.41
