"""The content of an index: the labels of the clips, and one or more vectors of each clip.

Rows are added at the end, in blocks that never move. The rows of a removed clip stay as dead rows.
If too many rows are dead, the others are copied. A search reads a `RowsView`, which later changes
do not affect.
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
from app.search.index.column import Column
from app.search.index.labels import Labels, LabelView
from app.store.clips.index_feed import IndexedClip

BLOCK = 32_768
"""The number of rows of a full block."""
MAX_FEW_DEAD = 4096
"""Up to this number of dead rows, no rows are copied."""
COPY_BATCH = 5000
"""The number of rows that are copied at a time when the dead rows are dropped."""
GATHER_RATIO = 4
"""If less than one row of a block in this many is needed, only the needed rows are copied and
multiplied. Else the whole block is multiplied."""


@dataclass(frozen=True, slots=True)
class Layout:
    """How the stored arrays of a clip become its rows.

    arrays: their names in the store. Their rows are put side by side. The first `facts` numbers
    of a row describe it (a time, a radius). The other `width` numbers are the vector.
    several: whether a clip has any number of rows (m, facts + width), or one (facts + width,).
    max_dead: the largest share of dead rows; if it is exceeded, the others are copied.
    """

    arrays: tuple[str, ...]
    width: int
    facts: int = 0
    several: bool = False
    max_dead: float = 0.5

    def rows_of(self, array: NDArray[Any] | None) -> NDArray[Any] | None:
        """(m, facts + width) the rows of a clip, m > 0; None if `array` has another shape.

        Arrays of an earlier version of the analysis can have another shape.
        """
        lengths = (self.facts + self.width,)
        if array is None or array.shape[self.several :] != lengths or not array.size:
            return None
        return array.reshape(-1, *lengths)


@dataclass(frozen=True, slots=True)
class RowsView:
    """Rows at one moment.

    labels: of the n clips. blocks: the vectors of all rows. facts: (rows, f) float32, see
    `Layout`. owners: (rows,) the number of each row's clip, ascending. starts: (n,) the first row
    of each clip. owners and starts are None if every clip has one row.
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
        own, first = self.rows_of(mask), 0
        parts = []
        for block in self.blocks:
            parts.append(own[first : first + len(block)])
            first += len(block)
        return parts

    def distances(self, queries: FloatArray, rows: IntArray) -> FloatArray:
        """(q, k) float32 Euclidean distances of `queries` (q, width) to ascending `rows` (k,)."""
        distances = np.empty((len(queries), len(rows)), dtype=np.float32)
        queries = queries.astype(np.float32, copy=False)
        first = start = 0
        for block in self.blocks:
            check()
            stop = start + int(np.searchsorted(rows[start:], first + len(block)))
            own = rows[start:stop] - first
            np.sqrt(_squared_distances(queries, block, own), out=distances[:, start:stop])
            first, start = first + len(block), stop
        return distances

    def vectors(self, rows: IntArray) -> FloatArray:
        """(k, width) float32 copies of the vectors of `rows` (k,), in any order."""
        width = self.blocks[0].vectors.shape[1] if self.blocks else 0
        found = np.empty((len(rows), width), dtype=np.float32)
        first = 0
        for block in self.blocks:
            own = np.flatnonzero((rows >= first) & (rows < first + len(block)))
            found[own] = block.vectors[rows[own] - first]
            first += len(block)
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
        """The number of clips that were not removed."""
        return len(self._labels)

    def put(self, clips: Sequence[IndexedClip]) -> None:
        """Add clips, each once, and remove their earlier rows; a clip may have no usable array."""
        self.remove([clip.id for clip in clips])
        rows = [(clip, self._layout.rows_of(clip.array)) for clip in clips]
        usable = [(clip, some) for clip, some in rows if some is not None]
        if usable:
            self._append([clip for clip, _ in usable], [some for _, some in usable])

    def remove(self, clip_ids: Iterable[str]) -> None:
        """Remove the clips that are in the index."""
        numbers = self._labels.remove(clip_ids)
        self._dead += int(self._counts()[numbers].sum()) if numbers else 0

    @property
    def is_wasteful(self) -> bool:
        """Whether more rows are dead than the layout allows."""
        return self._dead > max(MAX_FEW_DEAD, self._layout.max_dead * self._vectors.count)

    def living(self) -> Rows:
        """A copy without dead rows.

        It is made in batches, to bound the memory.
        """
        copy = Rows(self._layout)
        numbers = np.flatnonzero(self._labels.view().alive)
        batches = np.cumsum(self._counts()[numbers]) // COPY_BATCH
        for some in np.split(numbers, np.flatnonzero(np.diff(batches)) + 1):
            copy.put([self._labels.clip_at(n, self._array_at(n)) for n in some.tolist()])
        return copy

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
        # all rows of all clips, (rows, facts + width)
        joined = np.concatenate(rows)
        if self._layout.several:
            numbers = self._labels.used + np.arange(len(clips))
            self._starts.extend(self._vectors.count + np.cumsum([0, *counts[:-1]]))
            self._owners.extend(np.repeat(numbers, counts))
        self._facts.extend(joined[:, : self._layout.facts])
        self._vectors.extend(joined[:, self._layout.facts :])
        self._labels.add(clips)

    def _counts(self) -> IntArray:
        """(n,) rows of each clip that was added, dead or alive."""
        if not self._layout.several:
            return np.ones(self._labels.used, dtype=np.int64)
        return np.diff(self._starts.view(), append=self._vectors.count)

    def _array_at(self, number: int) -> NDArray[Any]:
        """The array with which a clip was added."""
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
    every = squared_distances(queries, block.vectors, block.squares)
    return every if len(rows) == len(block) else every[:, rows]


class _Vectors:
    """Vectors (rows, width) float32, in blocks that are filled one after the other."""

    def __init__(self, width: int) -> None:
        self.count = 0
        self._width = width
        self._full: list[Block] = []
        self._vectors, self._squares = self._empty()

    def extend(self, vectors: FloatArray) -> None:
        """Add vectors (m, width)."""
        done = 0
        while done < len(vectors):
            first = self.count % BLOCK
            some = vectors[done : done + BLOCK - first]
            stop = first + len(some)
            self._vectors[first:stop] = some
            self._squares[first:stop] = squared_lengths(self._vectors[first:stop])
            self.count += len(some)
            done += len(some)
            if stop == BLOCK:
                self._full.append(Block(self._vectors, self._squares))
                self._vectors, self._squares = self._empty()

    def part(self, first: int, stop: int) -> FloatArray:
        """(stop - first, width) a copy of the vectors of these rows."""
        blocks = [*(block.vectors for block in self._full), self._vectors]
        return np.concatenate(
            [
                blocks[i][max(first - i * BLOCK, 0) : stop - i * BLOCK]
                for i in range(first // BLOCK, (stop - 1) // BLOCK + 1)
            ]
        )

    def view(self) -> tuple[Block, ...]:
        """All vectors so far."""
        used = self.count % BLOCK
        last = [Block(self._vectors[:used], self._squares[:used])] if used else []
        return (*self._full, *last)

    def _empty(self) -> tuple[FloatArray, FloatArray]:
        # The system allocates the memory of an empty array only when it is written.
        return np.empty((BLOCK, self._width), np.float32), np.empty(BLOCK, np.float32)
