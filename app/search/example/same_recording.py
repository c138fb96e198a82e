"""Whether a clip has the same recording as the query, and what follows for the other clips.

A query may be a part of a clip, the clip at another speed, or the same take in another format. Then
its containment (see `containment`) in that clip is far below its containment in all other clips, as
in the ratio test of Lowe 2004, "Distinctive image features", section 7.1. And then the clip says
better than the query what else is alike: the query may lack the half that makes a task what it is.
So the distances of the other clips become those to this clip, as far as it is believed. Our own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.numerics.arrays import FloatArray
from app.search.example.fusion import LEAST_SHARE

LEVEL = 2
"""The clips after this many say how well the query is contained in any motion like it. So up to two
files of one take can be told from the rest. Of 1, 2 and 3, the same recording was recognized in
.953, .955 and .943 of 750 cases (see `HALF`; poses as they are, no FARTHEST)."""

FARTHEST = 0.4
"""Larger distances of containment count as this one. Of .4, .5 and .6, on the cases of `HALF`, the
mean logarithm of the probability of what is true is -.097, -.107 and -.113 (with straight lines
between frames, in place of cubic ones: -.075)."""

HALF, STEEPNESS = 0.61, 13.0
"""The ratio of the smallest distance to the level that the same recording has with probability .5,
and the exponent that makes the odds. By logistic regression on 84 clips of three sources that are
cut (three ways), slow, fast and repeated, each with and without its original in the library. With
the person left out of the regression, the original is recognized in .962 of 495 cases, and another
clip is taken for it in .021 of 513."""

LEAST_BELIEF = 0.01
"""Smaller probabilities count as 0. So most queries are spared the second warping."""

MOST_BELIEF = 1.0 - LEAST_SHARE
"""Largest probability: a part of a motion must be farther than an equal motion."""


@dataclass(frozen=True, slots=True)
class SameRecording:
    """number: of the clip. belief: the probability, above 0 and below 1."""

    number: int
    belief: float

    def seen(self, own: FloatArray, others: FloatArray) -> FloatArray:
        """The distances (m,) of clips, from those to the query (m,) and to the same recording (m,).

        The recording has distance 0 to itself, so it comes near the query.
        """
        return np.asarray((1.0 - self.belief) * own + self.belief * others)


def same_recording(contained: FloatArray) -> SameRecording | None:
    """The clip that has the query's recording, by the distances of containment (n,) of clips.

    None if there is none, or if there are too few clips to tell.
    """
    if len(contained) <= LEVEL:
        return None
    distances = np.minimum(contained, FARTHEST)
    level = float(np.partition(distances, LEVEL)[LEVEL])
    number = int(np.argmin(distances))
    # (ratio / HALF) ** STEEPNESS are the odds against it; multiplied out, because a level may be 0
    against, support = float(distances[number]) ** STEEPNESS, (HALF * level) ** STEEPNESS
    if support <= 0.0:
        return None
    belief = min(support / (support + against), MOST_BELIEF)
    return SameRecording(number, belief) if belief >= LEAST_BELIEF else None
