"""What an index holds: the clips' labels, and one vector of each clip or several.

Rows are added at the end, in blocks that never move. The rows of a clip that is gone stay as dead
rows; when too many are dead, the living rows are copied. A search reads a `RowsView`, which no
later change touches.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.deadline import check
from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.numerics.euclidean import squared_distances
from app.numerics.nearest import Block, squared_lengths
from app.search.index.labels import Column, Labels, LabelView
from app.store.clips.index_feed import IndexedClip

BLOCK = 32_768
"""Rows of one block."""
MAX_FEW_DEAD = 4096
"""So many dead rows are kept however few are alive."""
COPY_BATCH = 5000
"""Rows that are copied at a time when the dead rows are dropped."""
GATHER_RATIO = 4
"""Where fewer than one row of a block in so many is asked for, these are copied and multiplied;
else the whole block is."""


@dataclass(frozen=True, slots=True)
class Layout:
    """How the stored arrays of a clip become its rows.

    arrays: their names in the store. A row is a row of each array, side by side: `facts` numbers
    that describe the row (a time, a radius), then `width` numbers that are compared.
    several: whether a clip has any number of rows (m, facts + width), or one (facts + width,).
    max_dead: the share of rows that may be dead before the others are copied.
    """

    arrays: tuple[str, ...]
    width: int
    facts: int = 0
    several: bool = False
    max_dead: float = 0.5

    def rows_of(self, array: NDArray[Any] | None) -> NDArray[Any] | None:
        """(m, facts + width) rows of a clip, m > 0; None where `array` has another shape.

        An array of an earlier analysis has one, until the clip is analyzed again.
        """
        lengths = (self.facts + self.width,)
        if array is None or array.shape[self.several :] != lengths or not array.size:
            return None
        return array.reshape(-1, *lengths)


@dataclass(frozen=True, slots=True)
class RowsView:
    """Rows at one moment.

    labels: of the n clips; blocks: vectors of all rows; facts: (rows, f) float32, what describes
    each row; owners: (rows,) each row's clip, ascending; starts: (n,) each clip's first row. Both
    are None where every clip has one row.
    """

    labels: LabelView
    blocks: tuple[Block, ...]
    facts: FloatArray
    owners: IntArray | None
    starts: IntArray | None

    @property
    def nbytes(self) -> int:
        """Bytes of the rows, without the labels."""
        columns = (self.facts, self.owners, self.starts)
        vectors = sum(block.vectors.nbytes + block.squares.nbytes for block in self.blocks)
        return vectors + sum(column.nbytes for column in columns if column is not None)

    def rows_of(self, mask: BoolArray) -> BoolArray:
        """(rows,) whether each row belongs to a clip in `mask` (n,)."""
        return mask if self.owners is None else mask[self.owners]

    def masks(self, mask: BoolArray) -> list[BoolArray]:
        """For each block, which of its rows (m,) belong to a clip in `mask` (n,)."""
        ends = np.cumsum([len(block) for block in self.blocks])
        return np.split(self.rows_of(mask), ends[:-1]) if self.blocks else []

    def distances(self, queries: FloatArray, rows: IntArray) -> FloatArray:
        """(q, k) float32 Euclidean distances of `queries` (q, width) to ascending `rows` (k,)."""
        found = np.empty((len(queries), len(rows)), dtype=np.float32)
        queries = queries.astype(np.float32, copy=False)
        first = start = 0
        for block in self.blocks:
            check()
            stop = start + int(np.searchsorted(rows[start:], first + len(block)))
            own = rows[start:stop] - first
            np.sqrt(_squared_distances(queries, block, own), out=found[:, start:stop])
            first, start = first + len(block), stop
        return found


class Rows:
    """The rows of an index; clips are added and removed."""

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        self._labels = Labels()
        self._vectors = _Vectors(layout.width)
        self._facts = Column(np.float32, (layout.facts,))
        self._owners = Column(np.int32)
        self._starts = Column(np.int64)
        self._dead = 0

    def __len__(self) -> int:
        """Clips that are there."""
        return len(self._labels)

    def put(self, clips: Sequence[IndexedClip]) -> None:
        """Add clips, each once, and drop what was known of them; some may have no array."""
        self.remove([clip.id for clip in clips])
        rows = [(clip, self._layout.rows_of(clip.array)) for clip in clips]
        there = [(clip, some) for clip, some in rows if some is not None]
        if there:
            self._append([clip for clip, _ in there], [some for _, some in there])

    def remove(self, clip_ids: Iterable[str]) -> None:
        """Drop those of the clips that are there."""
        numbers = self._labels.remove(clip_ids)
        self._dead += int(self._counts()[numbers].sum()) if numbers else 0

    @property
    def is_wasteful(self) -> bool:
        """Whether more rows are dead than the layout allows."""
        return self._dead > max(MAX_FEW_DEAD, self._layout.max_dead * self._vectors.count)

    def living(self) -> Rows:
        """The same without dead rows."""
        found = Rows(self._layout)
        numbers = np.flatnonzero(self._labels.view().alive)
        batches = np.cumsum(self._counts()[numbers]) // COPY_BATCH
        for some in np.split(numbers, np.flatnonzero(np.diff(batches)) + 1):
            found.put([self._labels.clip_at(n, self._array_at(n)) for n in some.tolist()])
        return found

    def view(self) -> RowsView:
        """The rows at this moment."""
        several = self._layout.several
        return RowsView(
            labels=self._labels.view(),
            blocks=self._vectors.view(),
            facts=self._facts.view(),
            owners=self._owners.view() if several else None,
            starts=self._starts.view() if several else None,
        )

    def _append(self, clips: Sequence[IndexedClip], rows: list[NDArray[Any]]) -> None:
        counts = [len(some) for some in rows]
        every = np.concatenate(rows)
        if self._layout.several:
            numbers = self._labels.used + np.arange(len(clips))
            self._starts.extend(self._vectors.count + np.cumsum([0, *counts[:-1]]))
            self._owners.extend(np.repeat(numbers, counts))
        self._facts.extend(every[:, : self._layout.facts])
        self._vectors.extend(every[:, self._layout.facts :])
        self._labels.add(clips)

    def _counts(self) -> IntArray:
        """(n,) rows of each clip that was added, dead or alive."""
        if not self._layout.several:
            return np.ones(self._labels.used, dtype=np.int64)
        return np.diff(self._starts.view(), append=self._vectors.count)

    def _array_at(self, number: int) -> NDArray[Any]:
        """The array that a clip was added with."""
        first, stop = number, number + 1
        if self._layout.several:
            starts = self._starts.view()
            first = int(starts[number])
            stop = int(starts[stop]) if stop < len(starts) else self._vectors.count
        rows = np.hstack([self._facts.view()[first:stop], self._vectors.part(first, stop)])
        return rows if self._layout.several else rows[0]


def _squared_distances(queries: FloatArray, block: Block, rows: IntArray) -> FloatArray:
    """(q, k) squared distances of `queries` (q, width) to ascending `rows` (k,) of a block."""
    if GATHER_RATIO * len(rows) < len(block):
        vectors, squares = block.vectors.take(rows, axis=0), block.squares.take(rows)
        return squared_distances(queries, vectors, squares)
    found = squared_distances(queries, block.vectors, block.squares)
    return found if len(rows) == len(block) else found[:, rows]


class _Vectors:
    """Vectors (rows, width) float32 in blocks that are filled one after another."""

    def __init__(self, width: int) -> None:
        self.count = 0
        self._width = width
        self._full: list[Block] = []
        self._vectors, self._squares = self._empty()

    def extend(self, vectors: FloatArray) -> None:
        """Add vectors (m, width)."""
        done = 0
        while done < len(vectors):
            held = self.count % BLOCK
            some = vectors[done : done + BLOCK - held]
            stop = held + len(some)
            self._vectors[held:stop] = some
            self._squares[held:stop] = squared_lengths(self._vectors[held:stop])
            self.count += len(some)
            done += len(some)
            if stop == BLOCK:
                self._full.append(Block(self._vectors, self._squares))
                self._vectors, self._squares = self._empty()

    def part(self, first: int, stop: int) -> FloatArray:
        """(stop - first, width) copied."""
        blocks = [*(block.vectors for block in self._full), self._vectors]
        return np.concatenate(
            [
                blocks[i][max(first - i * BLOCK, 0) : stop - i * BLOCK]
                for i in range(first // BLOCK, (stop - 1) // BLOCK + 1)
            ]
        )

    def view(self) -> tuple[Block, ...]:
        """All vectors so far."""
        held = self.count % BLOCK
        last = [Block(self._vectors[:held], self._squares[:held])] if held else []
        return (*self._full, *last)

    def _empty(self) -> tuple[FloatArray, FloatArray]:
        # Memory is taken only as it is written.
        return np.empty((BLOCK, self._width), np.float32), np.empty(BLOCK, np.float32)
