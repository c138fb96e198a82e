"""Shares of votes: an interval around a share, and whether it differs from one half."""

from __future__ import annotations

from itertools import accumulate
from math import sqrt

Z_95 = 1.959963984540054
"""Standard deviations of a normal distribution within which 95 % lie."""


def wilson_interval(successes: int, trials: int, z: float = Z_95) -> tuple[float, float]:
    """Where the true share lies, with 95 % confidence (Wilson 1927).

    It stays within 0..1 and is right for few trials and for shares near the ends; (0, 1)
    without trials. Raises ValueError where there are more successes than trials.
    """
    _check(successes, trials)
    if not trials:
        return 0.0, 1.0
    share, square = successes / trials, z * z
    centre = (share + square / (2 * trials)) / (1 + square / trials)
    reach = z / (1 + square / trials)
    reach *= sqrt(share * (1 - share) / trials + square / (4 * trials * trials))
    low = 0.0 if successes == 0 else centre - reach
    high = 1.0 if successes == trials else centre + reach
    return max(low, 0.0), min(high, 1.0)


def fair_coin_probability(successes: int, trials: int) -> float:
    """The chance that a fair coin shows a share at least as far from one half: the exact
    two-sided binomial test; 1 without trials.

    Raises ValueError where there are more successes than trials.
    """
    _check(successes, trials)
    fewer = min(successes, trials - successes)
    if 2 * fewer == trials:
        return 1.0
    # Whole numbers until the end: no tail is lost to rounding.
    ways = sum(accumulate(range(fewer), lambda ways, k: ways * (trials - k) // (k + 1), initial=1))
    return float(min(1.0, 2 * ways / 2**trials))


def _check(successes: int, trials: int) -> None:
    if not 0 <= successes <= trials:
        raise ValueError(f"expected 0 to {trials} successes, found {successes}")
