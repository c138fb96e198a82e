"""How well clips fit a query of several parts, some of them for something and others against it.

Each part gives a clip the probability that the part is true of it: that it is of the same kind as
an example, or that it carries the words.

The examples for something show one kind of motion. So they are one opinion together: the weighted
mean of their log odds (a logarithmic opinion pool; Genest and Zidek 1986, "Combining Probability
Distributions", Statistical Science 1, section 3). What remains counts as independent, as words do
in a search by words: the pool, the words, and each example against something. So the probability
that all of it holds is the product of p and of 1 - p. We write -ln of it, the surprise, which is a
sum. A weight multiplies the surprise of its part; that of the pool is the sum of its weights.

The sum is divided by the sum of the weights. So a distance does not grow with the number of parts,
and exp(-distance), the geometric mean of the probabilities, is a score that people can compare.

Measured on trials like those of `tests/bench/test_composed.py`, 200 of each kind: two examples of
one task find it with P@10 .72; with their product .70, with one of them .64. An example and a word
find what is both with P@R .77; with the sum of their log odds .58, because that pays for the word
without end, however far the example is.
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
    """One part of a query: its weight, above 0, and whether it is against something.

    is_pooled: whether it is one opinion together with other parts, as examples for something are.
    """

    weight: float = 1.0
    is_against: bool = False
    is_pooled: bool = False


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
    pairs = list(zip(parts, probabilities, strict=True))
    pooled = [(part, likely) for part, likely in pairs if part.is_pooled]
    surprises = [_weighted(part, likely) for part, likely in pairs if not part.is_pooled]
    if pooled:
        surprises.append(_weighted(Part(_weight(pooled)), _pool(pooled)))
    return np.asarray(np.sum(surprises, axis=0) / sum(part.weight for part in parts))


def costs(parts: Sequence[Part], probabilities: Sequence[float]) -> list[float]:
    """What each part adds to the mean surprise of a clip; the sum is `mean_surprise`.

    The cost of the pool is divided among its parts in proportion to the surprise of each alone.
    """
    likely = [np.array([one]) for one in probabilities]
    pooled = [(part, one) for part, one in zip(parts, likely, strict=True) if part.is_pooled]
    alone = [float(_weighted(part, one)[0]) for part, one in zip(parts, likely, strict=True)]
    ratio = 1.0
    if pooled:
        together = float(_weighted(Part(_weight(pooled)), _pool(pooled))[0])
        each = sum(cost for part, cost in zip(parts, alone, strict=True) if part.is_pooled)
        ratio = together / each if each > 0.0 else 1.0
    total = sum(part.weight for part in parts)
    return [
        cost * (ratio if part.is_pooled else 1.0) / total
        for part, cost in zip(parts, alone, strict=True)
    ]


def _weighted(part: Part, likely: FloatArray) -> FloatArray:
    """(n,) the weighted surprise of one part."""
    return part.weight * surprise(likely, is_against=part.is_against)


def _weight(pooled: Sequence[tuple[Part, FloatArray]]) -> float:
    return sum(part.weight for part, _ in pooled)


def _pool(pooled: Sequence[tuple[Part, FloatArray]]) -> FloatArray:
    """(n,) the probability of the weighted mean of log odds."""
    odds = [
        part.weight * (surprise(likely, is_against=True) - surprise(likely, is_against=False))
        for part, likely in pooled
    ]
    mean = np.sum(odds, axis=0) / _weight(pooled)
    return np.asarray(1.0 / (1.0 + np.exp(-mean)))
