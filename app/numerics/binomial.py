"""Shares of votes: an interval around a share, and whether it differs from one half.

scipy computes both, but refuses zero votes. Here the results are also defined for zero votes.
"""

from __future__ import annotations

CONFIDENCE = 0.95
"""The probability that the interval holds the true share."""


def wilson_interval(successes: int, trials: int) -> tuple[float, float]:
    """The lower and upper end, each 0..1, of Wilson's 95 % interval around a share.

    successes: 0..trials. The interval (Wilson 1927) also holds for few trials and for shares
    near 0 or 1. Without trials it is (0, 1). Raises ValueError if `successes` is negative or
    larger than `trials`.
    """
    from scipy.stats import binomtest  # slow to load

    if _has_no_trials(successes, trials):
        return 0.0, 1.0
    interval = binomtest(successes, trials).proportion_ci(CONFIDENCE, method="wilson")
    return float(interval.low), float(interval.high)


def fair_coin_probability(successes: int, trials: int) -> float:
    """The probability, 0..1, that a fair coin gives a share at least this far from one half.

    This is the p-value of the exact two-sided binomial test. Without trials it is 1.
    Raises ValueError if `successes` is negative or larger than `trials`.
    """
    from scipy.stats import binomtest  # slow to load

    return 1.0 if _has_no_trials(successes, trials) else float(binomtest(successes, trials).pvalue)


def _has_no_trials(successes: int, trials: int) -> bool:
    """Whether there are no trials. Raises ValueError if the counts are impossible."""
    if not 0 <= successes <= trials:
        raise ValueError(f"expected 0 to {trials} successes, found {successes}")
    return trials == 0
