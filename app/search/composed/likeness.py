"""From the distance between two motions to the probability that they are of the same kind.

A distance alone says little: its size depends on the method, on the query and on the library. So it
is divided by the query's typical distance, the median over the library. On 489 real clips, the
share of pairs with the same task is then a curve that the Hill function follows closely (at 0.37 to
0.5 of the median .46 measured and .41 fitted, at 0.6 to 0.74 .063 and .065, above it 0 to .005 and
.001 to .011). The constants belong to the method, not to the library.

Two other scales were measured by vectors, on 202 trials like those of
`tests/bench/test_composed.py`: the share of the library that is farther, and 1 / (1 + d) with one
constant. Both give most of the library a probability that is far from 0. Then an example against
something outweighs the one for something: P@10 .13 and .29, with this curve .53, without the
example against .51.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.numerics.arrays import FloatArray, IntArray
from app.search.example.methods import Method

SAMPLE = 1000
"""Clips of the library from which the typical distance of vectors is taken."""

COSTLY_SAMPLE = 100
"""The same for methods that warp or correlate, each clip in a fifth of a millisecond."""

SMALLEST = 1e-9
"""The smallest typical distance: a library may have copies of one motion only."""


@dataclass(frozen=True, slots=True)
class Curve:
    """Probability 1 / (1 + (d / (ratio t))^power) at distance d, where t is typical.

    ratio: the distance with probability 1/2, in typical distances.
    """

    ratio: float
    power: float

    def probabilities(self, distances: FloatArray, typical: float) -> FloatArray:
        """(n,) probabilities of distances (n,) >= 0, falling; typical: above 0, in their unit.

        An infinite distance has probability 0.
        """
        with np.errstate(over="ignore"):
            relative = np.asarray(distances, dtype=np.float64) / (self.ratio * typical)
            return np.asarray(1.0 / (1.0 + relative**self.power))


CURVES = {
    Method.VECTOR: Curve(0.4, 5.0),
    Method.FUSED: Curve(1.7, 4.5),
    Method.DTW: Curve(0.3, 3.0),
    Method.MSV_DTW: Curve(0.03, 0.84),
    Method.MSV_XCORR: Curve(0.009, 0.62),
}
"""The curve of each method. The typical distance of FUSED is that of VECTOR. VECTOR, DTW and the
MSV methods have the curve of maximum likelihood. That of FUSED is (2.1, 7), by 70 queries among
these clips. It is flatter and lower here, by as much as the best of 574 trials on these clips
(P@10, MAP) was when fused distances were smaller: (1.2, 4) beside a likeliest (1.5, 6)."""


def typical_distance(sampled: FloatArray) -> float:
    """The typical distance of a query, from its distances (m,) to a sample of the library.

    1 without a finite distance.
    """
    known = sampled[np.isfinite(sampled)]
    return max(float(np.median(known)), SMALLEST) if len(known) else 1.0


def even_sample(numbers: IntArray, count: int) -> IntArray:
    """At most `count` of ascending `numbers` (n,), evenly spaced, always the same ones."""
    if len(numbers) <= count:
        return numbers
    return np.asarray(numbers[np.linspace(0, len(numbers) - 1, count).round().astype(np.int64)])
