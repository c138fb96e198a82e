"""What an index holds: the clips' labels, and one vector of each clip or several.

Rows only grow, in blocks that never move; a clip that went stays as a dead row until half
of all are dead, when the living are copied. What a search reads is a `RowsView`, which
nothing that comes later changes.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.numerics.nearest import Block, squared_lengths
from app.search.index.labels import Column, Labels, LabelView
from app.store.clips.index_feed import IndexedClip

BLOCK = 32_768
"""Rows of one block."""
FEW_DEAD = 4096
"""Dead clips that are put up with, however few are alive."""
COPIED = 5000
"""Clips copied at a time when the dead are dropped."""


@dataclass(frozen=True, slots=True)
class Layout:
    """How a stored array becomes rows: (told + width,) one row, or (m, told + width) m rows.

    array: its name in the store; width: numbers of a row that are compared; told: numbers
    before them that say what the row is; several: whether a clip may have any number of rows.
    """

    array: str
    width: int
    told: int = 0
    several: bool = False

    def rows_of(self, array: NDArray[Any] | None) -> NDArray[Any] | None:
        """(m, told + width) rows of a clip's array, m > 0; None where it is not such an array.

        So it is with clips of an earlier analysis, until they are analysed again.
        """
        lengths = (self.told + self.width,)
        if array is None or array.shape[self.several :] != lengths or not array.size:
            return None
        return array.reshape(-1, *lengths)


@dataclass(frozen=True, slots=True)
class RowsView:
    """Rows at one moment.

    labels: of the n clips; blocks: vectors of all rows; told: (rows, t) float32 what rows say
    of themselves; owners: (rows,) each row's clip, ascending; starts: (n,) each clip's first row.
    """

    labels: LabelView
    blocks: tuple[Block, ...]
    told: FloatArray
    owners: IntArray | None
    starts: IntArray | None

    def masks(self, passing: BoolArray) -> list[BoolArray]:
        """Of each block, which rows (m,) belong to the clips (n,) that are `passing`."""
        rows = passing if self.owners is None else passing[self.owners]
        ends = np.cumsum([len(block) for block in self.blocks])
        return np.split(rows, ends[:-1]) if self.blocks else []


class Rows:
    """The rows of an index, to which clips are added and from which they are taken."""

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        self._labels = Labels()
        self._vectors = _Vectors(layout.width)
        self._told = Column(np.float32, (layout.told,))
        self._owners = Column(np.int32)
        self._starts = Column(np.int64)

    def __len__(self) -> int:
        """Clips that are there."""
        return len(self._labels)

    def put(self, clips: Sequence[IndexedClip]) -> None:
        """Add clips, each once, in place of what was known of them; some may have no array."""
        self._labels.remove([clip.id for clip in clips])
        rows = [(clip, self._layout.rows_of(clip.array)) for clip in clips]
        there = [(clip, some) for clip, some in rows if some is not None]
        if there:
            self._append([clip for clip, _ in there], [some for _, some in there])

    def remove(self, clip_ids: Iterable[str]) -> None:
        """Forget clips; those that are not known are nothing to forget."""
        self._labels.remove(clip_ids)

    @property
    def is_wasteful(self) -> bool:
        """Whether most rows are dead."""
        return self._labels.used - len(self) > max(FEW_DEAD, len(self))

    def living(self) -> Rows:
        """The same without dead rows."""
        found = Rows(self._layout)
        numbers = np.flatnonzero(self._labels.view().alive)
        for start in range(0, len(numbers), COPIED):
            some = numbers[start : start + COPIED].tolist()
            found.put([self._labels.clip_at(n, self._array_at(n)) for n in some])
        return found

    def view(self) -> RowsView:
        """The rows at this moment."""
        several = self._layout.several
        return RowsView(
            labels=self._labels.view(),
            blocks=self._vectors.view(),
            told=self._told.view(),
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
        self._told.extend(every[:, : self._layout.told])
        self._vectors.extend(every[:, self._layout.told :])
        self._labels.add(clips)

    def _array_at(self, number: int) -> NDArray[Any]:
        """A clip's array as it was given."""
        first, stop = number, number + 1
        if self._layout.several:
            starts = self._starts.view()
            first = int(starts[number])
            stop = int(starts[stop]) if stop < len(starts) else self._vectors.count
        rows = np.hstack([self._told.view()[first:stop], self._vectors.part(first, stop)])
        return rows if self._layout.several else rows[0]


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
