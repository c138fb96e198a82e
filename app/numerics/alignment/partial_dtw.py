"""Dynamic time warping of motions of which one may be a part of the other, at any tempo.

One of the two sequences is matched whole, the other from any start to any end:

    D[i, j] = c[i, j] + min over 0 <= s <= MAX_STEP of D[i-1, j-s],      D[-1, j] = 0.

Every frame of the whole one has weight 1 (the asymmetric form of Sakoe and Chiba 1978, table I,
with free ends). So min over j of D[n-1, j] / n is the mean distance of its frames to the part of
the other that they are matched with, whatever the lengths. A crop is a part of its original, and
an original is a part of its repetition. The other may stand still, or pass MAX_STEP times as
fast, so the tempo hardly matters. No cell depends on its own row, so one numpy step computes a
row of many candidates.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.deadline import check
from app.numerics.alignment.cost_tables import as_table, batches, costs, side_by_side
from app.numerics.arrays import FloatArray

MAX_STEP = 3
"""The most frames of the other sequence that one frame of the whole one advances."""

MAX_FRAMES = 600
"""Longer sequences are thinned to at most this number of frames, which bounds time and memory."""


@dataclass(frozen=True, slots=True)
class PartialDistances:
    """The distances of a query and c candidates, in the unit of the sequences.

    inside: (c,) of the whole query to a part of each candidate. around: (c,) of each whole
    candidate to a part of the query.
    """

    inside: FloatArray
    around: FloatArray


def partial_distances(query: FloatArray, candidates: Sequence[FloatArray]) -> PartialDistances:
    """The distances of `query` (n, d) and `candidates`, each (m, d), in the same unit.

    Computed in float32. Raises ValueError for an empty sequence, and DeadlineExceeded or
    ClientLeft (app.deadline).
    """
    table = _thinned(query)
    thinned = [_thinned(one) for one in candidates]
    lengths = np.array([len(one) for one in thinned], dtype=np.int64)
    if not len(table) or (len(lengths) and not lengths.min()):
        raise ValueError("cannot warp an empty sequence")
    inside, around = np.empty(len(lengths)), np.empty(len(lengths))
    center = table.mean(axis=0)  # differences of small numbers keep more digits
    for batch in batches(lengths, len(table)):
        frames = np.concatenate([thinned[i] for i in batch]) - center
        own = lengths[batch]
        cost = side_by_side(costs(table - center, frames, own), own)
        # A path at the repeated last frame of a candidate is one that stays there.
        inside[batch] = _least_by_row(cost)[-1] / len(table)
        by_row = _least_by_row(cost.transpose(1, 0, 2))
        around[batch] = by_row[own - 1, np.arange(len(own))] / own
    return PartialDistances(inside, around)


def _thinned(sequence: FloatArray) -> FloatArray:
    return as_table(sequence[:: -(-len(sequence) // MAX_FRAMES) or 1])


def _least_by_row(cost: FloatArray) -> FloatArray:
    """(n, c) the least D of each row, for costs (n, m, c) of c tables."""
    least = np.empty((len(cost), cost.shape[2]), dtype=cost.dtype)
    above = np.zeros(cost.shape[1:], dtype=cost.dtype)
    row = np.empty_like(above)
    for i, own in enumerate(cost):
        check()
        np.copyto(row, above)
        for step in range(1, MAX_STEP + 1):
            np.minimum(row[step:], above[:-step], out=row[step:])
        row += own
        row.min(axis=0, out=least[i])
        above, row = row, above
    return least
