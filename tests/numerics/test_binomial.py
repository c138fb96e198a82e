"""Votes: intervals and the exact test, by their definitions."""

from __future__ import annotations

from math import comb, sqrt

import pytest

from app.numerics.binomial import fair_coin_probability, wilson_interval

VOTES = [(0, 1), (1, 1), (0, 7), (5, 7), (17, 34), (29, 34), (32, 34), (34, 34), (92, 102)]


@pytest.mark.parametrize(("successes", "trials"), VOTES)
def test_the_probability_counts_all_shares_as_far_from_one_half(
    successes: int, trials: int
) -> None:
    far = [k for k in range(trials + 1) if abs(2 * k - trials) >= abs(2 * successes - trials)]
    expected = sum(comb(trials, k) for k in far) / 2**trials
    assert fair_coin_probability(successes, trials) == pytest.approx(expected)


@pytest.mark.parametrize(("successes", "trials"), VOTES)
def test_the_ends_of_the_interval_are_two_deviations_away(successes: int, trials: int) -> None:
    low, high = wilson_interval(successes, trials)
    assert 0 <= low <= successes / trials <= high <= 1
    for end, is_cut in ((low, successes == 0), (high, successes == trials)):
        apart = abs(end - successes / trials)
        deviation = sqrt(end * (1 - end) / trials)
        assert is_cut or apart == pytest.approx(1.959964 * deviation, rel=1e-5)


def test_the_paper_s_table_2_is_no_chance() -> None:
    low, high = wilson_interval(92, 102)
    assert low < 0.9 < high
    assert low > 0.8
    assert fair_coin_probability(92, 102) < 1e-15


def test_without_votes_the_result_is_neutral() -> None:
    assert wilson_interval(0, 0) == (0.0, 1.0)
    assert fair_coin_probability(0, 0) == 1.0


@pytest.mark.parametrize("count", [wilson_interval, fair_coin_probability])
def test_more_votes_than_voters_are_refused(count: object) -> None:
    with pytest.raises(ValueError, match="expected 0 to 2 successes, found 3"):
        count(3, 2)  # type: ignore[operator]
    with pytest.raises(ValueError, match="found -1"):
        count(-1, 2)  # type: ignore[operator]


def test_thousands_of_votes_give_finite_results() -> None:
    assert 0 <= fair_coin_probability(4_000, 10_000) < 1e-80
    low, high = wilson_interval(4_000, 10_000)
    assert 0.39 < low < 0.4 < high < 0.41
