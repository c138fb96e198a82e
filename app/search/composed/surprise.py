"""How well clips fit a query of several parts, some of them for something and others against it.

Each part gives a clip the probability that the part is true of it: that it is of the same kind as
an example, or that it carries the words. The parts count as independent, as words do in a search by
words. So the probability that all parts for something are true, and no part against something, is
the product of p and of 1 - p. We write -ln of it, the surprise, which is a sum. A weight multiplies
the surprise of its part.

The sum is divided by the sum of the weights. So a distance does not grow with the number of parts,
and exp(-distance), the geometric mean of the probabilities, is a score that people can compare.

A sum of log odds was tried too. It finds two examples of one task a little better, but an example
and a word worse: far from the example it pays for the word without end. (P@R .769 with the product,
.582 with the odds; `tests/bench/test_composed.py` has the trials.)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.numerics.arrays import FloatArray

CERTAINTY = 1e-12
"""Probabilities are kept this far from 0 and 1. So a surprise is at most 27.6."""


@dataclass(frozen=True, slots=True)
class Part:
    """One part of a query: its weight, above 0, and whether it is against something."""

    weight: float = 1.0
    is_against: bool = False


def surprise(probabilities: FloatArray, *, is_against: bool) -> FloatArray:
    """(n,) -ln of `probabilities` (n,) in 0..1; of 1 - them if the part is against something.

    It is finite, and at least 0.
    """
    likely = np.clip(probabilities, CERTAINTY, 1.0 - CERTAINTY)
    return np.asarray(-np.log1p(-likely) if is_against else -np.log(likely))


def mean_surprise(parts: Sequence[Part], probabilities: Sequence[FloatArray]) -> FloatArray:
    """(n,) the mean surprise of clips, weighted: the distance of a query of several parts.

    parts: at least one; probabilities: (n,) of each of them, in the same order.
    """
    total = sum(part.weight for part in parts)
    surprises = [
        part.weight * surprise(likely, is_against=part.is_against)
        for part, likely in zip(parts, probabilities, strict=True)
    ]
    return np.asarray(np.sum(surprises, axis=0) / total)
