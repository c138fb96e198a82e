"""Dynamic time warping of motions of which one may be a part of the other, at any tempo.

One of the two sequences is matched whole, the other from any start to any end:

    D[i, j] = c[i, j] + min over 0 <= s <= MAX_STEP of D[i-1, j-s],      D[-1, j] = 0.

Every frame of the whole one has weight 1 (the asymmetric form of Sakoe and Chiba 1978, table I,
with free ends). So min over j of D[n-1, j] / n is the mean distance of its frames to the part of
the other that they are matched with, whatever the lengths. A crop is a part of its original, and
an original is a part of its repetition. The other may stand still, or pass three times as fast, so
the tempo hardly matters. It also has the points halfway between its frames: so the result hardly
depends on the times of the samples. No cell depends on its own row, so one numpy step computes a
row of many candidates.

Each frame of the whole one costs at least as much as its nearest point of the other, in any order.
The mean of these costs is a lower bound, which takes a tenth of the time. So a caller who says from
where on distances do not matter is spared most of the warping, and gets the same distances.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.deadline import check
from app.numerics.alignment.cost_tables import as_table, batches, costs, side_by_side
from app.numerics.arrays import FloatArray, IntArray

MAX_STEP = 6
"""The most points of the other sequence that one frame of the whole one advances. There are two
points for each frame."""

MAX_FRAMES = 600
"""Longer sequences are thinned to at most this number of frames, which bounds time and memory."""


@dataclass(frozen=True, slots=True)
class PartialDistances:
    """The distances of a query and c candidates, in the unit of the sequences.

    inside: (c,) of the whole query to a part of each candidate. around: (c,) of each whole
    candidate to a part of the query. Infinity stands for a distance from its limit on.
    """

    inside: FloatArray
    around: FloatArray


@dataclass(frozen=True, slots=True)
class Limits:
    """Distances from these on do not matter. inside: of all candidates. around: (c,) of each."""

    inside: float
    around: FloatArray


def partial_distances(
    query: FloatArray, candidates: Sequence[FloatArray], limits: Limits | None = None
) -> PartialDistances:
    """The distances of `query` (n, d) and `candidates`, each (m, d), in the same unit.

    limits: None if all distances matter. Computed in float32. Raises ValueError for an empty
    sequence, and DeadlineExceeded or ClientLeft (app.deadline).
    """
    whole = _thinned(query)
    candidates = [_thinned(one) for one in candidates]
    lengths = np.array([len(one) for one in candidates], dtype=np.int64)
    if not len(whole) or (len(lengths) and not lengths.min()):
        raise ValueError("cannot warp an empty sequence")
    limits = limits or Limits(np.inf, np.full(len(lengths), np.inf))
    center = whole.mean(axis=0)  # differences of small numbers keep more digits
    whole = whole - center
    points = _with_midpoints(whole)
    inside, around = np.full(len(lengths), np.inf), np.full(len(lengths), np.inf)
    for batch in batches(2 * lengths, len(whole)):
        own = [candidates[i] - center for i in batch]
        # A path at the repeated last frame of a candidate is one that stays there.
        table = _Table.of(whole, [_with_midpoints(one) for one in own])
        near = np.flatnonzero(table.nearest(axis=1) < limits.inside)
        inside[batch[near]] = table.cheapest_paths(near)
        table = _Table.of(points, own)
        near = np.flatnonzero(table.nearest(axis=0) < limits.around[batch])
        around[batch[near]] = table.cheapest_paths(near, is_turned=True)
    return PartialDistances(inside, around)


@dataclass(frozen=True, slots=True)
class _Table:
    """The distances of n query points to the points of c candidates.

    costs: (n, k), the candidates one after the other; lengths: (c,), which sum up to k.
    """

    costs: FloatArray
    lengths: IntArray

    @classmethod
    def of(cls, query: FloatArray, candidates: Sequence[FloatArray]) -> _Table:
        """query: (n, d); candidates: (m, d) each."""
        lengths = np.array([len(one) for one in candidates])
        return cls(costs(query, np.concatenate(candidates), lengths), lengths)

    def nearest(self, axis: int) -> FloatArray:
        """(c,) the mean distance of the points of one motion to the nearest ones of the other.

        axis: 1 for the points of the query, 0 for those of the candidates.
        """
        firsts = np.cumsum(self.lengths) - self.lengths
        if axis == 1:
            return np.asarray(np.minimum.reduceat(self.costs, firsts, axis=1).mean(axis=0))
        return np.asarray(np.add.reduceat(self.costs.min(axis=0), firsts) / self.lengths)

    def cheapest_paths(self, chosen: IntArray, *, is_turned: bool = False) -> FloatArray:
        """(k,) mean costs of the cheapest paths of the `chosen` (k,) candidates.

        is_turned: whether the candidates are whole, and not the query.
        """
        if not len(chosen):
            return np.zeros(0)
        lengths = self.lengths[chosen]
        columns = np.repeat(np.isin(np.arange(len(self.lengths)), chosen), self.lengths)
        table = side_by_side(self.costs[:, columns], lengths)
        if is_turned:
            return np.asarray(_cheapest(table.transpose(1, 0, 2), lengths) / lengths)
        rows = np.full(len(chosen), len(table))
        return np.asarray(_cheapest(table, rows) / len(table))


def _with_midpoints(sequence: FloatArray) -> FloatArray:
    """(2 n - 1, d) the frames of `sequence` (n, d), and the points halfway between them.

    These are on the cubic curve through four frames: a straight line cuts the corners of a run,
    whose arms and legs turn back within two frames. Beyond the ends, the motion goes straight on.
    """
    points = np.repeat(sequence, 2, axis=0)[:-1]
    if len(sequence) > 1:
        before, after = 2 * sequence[:1] - sequence[1:2], 2 * sequence[-1:] - sequence[-2:-1]
        wide = np.concatenate([before, sequence, after])
        points[1::2] = (9 * (wide[1:-2] + wide[2:-1]) - wide[:-3] - wide[3:]) / 16
    return points


def _thinned(sequence: FloatArray) -> FloatArray:
    return as_table(sequence[:: -(-len(sequence) // MAX_FRAMES) or 1])


def _cheapest(cost: FloatArray, rows: IntArray) -> FloatArray:
    """(c,) the least D of the last row of each table.

    cost: (n, m, c) of c tables. rows: (c,) the number of rows of each table, at most n.
    """
    found = np.empty(cost.shape[2], dtype=cost.dtype)
    above, two, four = (np.zeros(cost.shape[1:], dtype=cost.dtype) for _ in range(3))
    last_rows = set((rows - 1).tolist())
    for i, own in enumerate(cost):
        check()
        # the minimum over a step of 0 to 1, of 0 to 3, and of 0 to MAX_STEP
        _min_with_shifted(above, 1, two)
        _min_with_shifted(two, 2, four)
        _min_with_shifted(four, MAX_STEP - 3, above)
        above += own
        if i in last_rows:
            np.copyto(found, above.min(axis=0), where=rows == i + 1)
    return found


def _min_with_shifted(values: FloatArray, shift: int, out: FloatArray) -> None:
    """Write the minimum of `values` (m, c) and of those `shift` rows before them to `out`."""
    out[:shift] = values[:shift]
    np.minimum(values[shift:], values[:-shift], out=out[shift:])
