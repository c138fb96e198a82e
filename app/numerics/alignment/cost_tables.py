"""The costs of matching the frames of one query with those of many candidates, as tables.

Candidates of similar length share a batch, whose costs are laid side by side. They are padded at
their ends.
"""

from __future__ import annotations

import numpy as np

from app.numerics.arrays import FloatArray, IntArray
from app.numerics.euclidean import distances, squared_lengths

MAX_CELLS_AT_ONCE = 1_000_000
"""The largest number of cost cells of one batch (4 bytes each). So a batch fits the caches."""

MAX_BATCH = 256
"""The largest number of candidates in a batch."""


def as_table(sequence: FloatArray) -> FloatArray:
    """(n, d) float32, for a sequence (n, d), or (n,) of one dimension."""
    table = np.asarray(sequence, dtype=np.float32)
    return table[:, None] if table.ndim == 1 else table


def batches(lengths: IntArray, frames: int) -> list[IntArray]:
    """Indices of candidates in groups of similar length whose costs fit MAX_CELLS_AT_ONCE.

    lengths: (c,). frames: the length of the query.
    """
    order = np.argsort(-lengths, kind="stable")
    batches: list[IntArray] = []
    first = 0
    while first < len(order):
        # lengths fall, so the first candidate of a batch is its longest
        max_length = int(lengths[order[first]])
        count = int(np.clip(MAX_CELLS_AT_ONCE // (frames * max_length), 1, MAX_BATCH))
        batches.append(order[first : first + count])
        first += count
    return batches


def costs(query: FloatArray, frames: FloatArray, lengths: IntArray) -> FloatArray:
    """(n, k) float32 Euclidean distances of `query` (n, d) to `frames` (k, d).

    frames: the candidates of `lengths` (c,) one after the other. Each candidate is multiplied
    alone, so that the cost of a pair does not depend on the other candidates of its batch: a
    ranking that is computed in pieces must agree with itself to the last bit.
    """
    if query.shape[1] == 1:
        differences = query - frames[:, 0]
        return np.asarray(np.abs(differences, out=differences))
    ends = np.cumsum(lengths).tolist()
    parts = [slice(first, stop) for first, stop in zip([0, *ends], ends, strict=False)]
    return distances(query, frames, squared_lengths(frames), parts)


def side_by_side(table: FloatArray, lengths: IntArray) -> FloatArray:
    """(n, m, c) C-contiguous costs, from `table` (n, k) of c candidates one after the other.

    lengths: (c,), of which m is the largest. Costs are moved, because frames are wider. After
    its end, a candidate repeats the costs of its last frame.
    """
    starts = np.cumsum(lengths) - lengths
    inside = np.minimum(np.arange(lengths.max())[:, None], lengths - 1)
    moved: FloatArray = np.take(table, (starts + inside).ravel(), axis=1)
    return moved.reshape(len(table), int(lengths.max()), len(lengths))
