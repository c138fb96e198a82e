"""Shares of votes: an interval around a share, and whether it differs from one half.

scipy computes both. Here they are also defined without votes, which scipy refuses.
"""

from __future__ import annotations

CONFIDENCE = 0.95
"""That the true share lies within the interval."""


def wilson_interval(successes: int, trials: int) -> tuple[float, float]:
    """The range, within 0..1, in which the true share lies with 95 % confidence (Wilson 1927).

    It is right for few trials and for shares near the ends too. It is (0, 1) without trials.
    Raises ValueError where there are more successes than trials.
    """
    from scipy.stats import binomtest  # slow to load

    if _has_none(successes, trials):
        return 0.0, 1.0
    found = binomtest(successes, trials).proportion_ci(CONFIDENCE, method="wilson")
    return float(found.low), float(found.high)


def fair_coin_probability(successes: int, trials: int) -> float:
    """The probability that a fair coin gives a share at least this far from one half.

    This is the exact two-sided binomial test. It is 1 without trials.
    Raises ValueError where there are more successes than trials.
    """
    from scipy.stats import binomtest  # slow to load

    return 1.0 if _has_none(successes, trials) else float(binomtest(successes, trials).pvalue)


def _has_none(successes: int, trials: int) -> bool:
    """Whether there are no trials. Raises ValueError where the counts cannot be."""
    if not 0 <= successes <= trials:
        raise ValueError(f"expected 0 to {trials} successes, found {successes}")
    return trials == 0
