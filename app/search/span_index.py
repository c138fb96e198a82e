"""The index over parts of clips: windows, or any others that an analysis stores.

A clip's parts are two arrays by name: vectors (w, d), and spans (w, 2), the start and end of
each in seconds, in order of start. They are kept as float32, clip after clip: 4 d + 16 bytes
a part. Nothing is loaded before the first search that asks.
"""

from __future__ import annotations

import threading
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.numerics.euclidean import squared_lengths
from app.search.labels import Column
from app.search.rank import IdArray
from app.store import arrays, library
from app.store.clips import in_batches
from app.store.engine import Tx
from app.store.store import Store

LOAD_BATCH = 64
"""Clips that are loaded at a time: an hour of motion has 3 MB of windows."""

MOST_DEAD = 0.25
"""Share of rows that may be of clips that changed or went; beyond it the others are copied."""


@dataclass(frozen=True, slots=True)
class Spans:
    """The parts of c clips at one moment: n rows, clip after clip, each clip's in their order.

    ids: (c,) clip ids; passing: (c,) whether a clip is there and meant; firsts, counts: (c,)
    its rows; owners: (n,) number of the clip, 0..c-1; starts, ends: (n,) float32 seconds;
    vectors: (n, d) float32; squares: (n,) their squared lengths.
    """

    ids: IdArray
    passing: BoolArray
    firsts: IntArray
    counts: IntArray
    owners: IntArray
    starts: FloatArray
    ends: FloatArray
    vectors: FloatArray
    squares: FloatArray

    def __len__(self) -> int:
        return len(self.owners)

    def rows(self) -> IntArray:
        """(k,) rows of the clips that pass, ascending."""
        return np.flatnonzero(self.passing[self.owners])

    def last_rows(self) -> IntArray:
        """(n,) for each row the last row of the same clip."""
        return np.asarray((self.firsts + self.counts - 1)[self.owners])


class SpanIndex:
    """The parts of all ready clips that have them, under the names of their two arrays."""

    def __init__(self, vectors: str, spans: str, width: int) -> None:
        """`width`: numbers of a vector."""
        self._names = vectors, spans
        self._rows = SpanRows(width)
        self._version = 0
        self._lock = threading.Lock()

    def __len__(self) -> int:
        """Rows in memory, those of clips that went included."""
        return len(self._rows.owners)

    @property
    def bytes_kept(self) -> int:
        """Bytes of the rows in memory."""
        return sum(column.view().nbytes for column in self._rows.by_row())

    def catch_up(self, store: Store) -> int:
        """Bring the index to the library's version and return that; it loads the first time.

        One cheap query when nothing is new.
        """
        with self._lock, store.read() as tx:
            changes = library.changed_since(tx, self._version)
            self._rows.remove((*changes.removed, *changes.changed))
            for some in in_batches(changes.changed, LOAD_BATCH):
                self._load(tx, some)
            if self._rows.dead > MOST_DEAD * len(self):
                self._rows = self._rows.without_the_dead()
            self._version = changes.version
            return self._version

    def view(self, clip_ids: Collection[str] | None = None) -> Spans:
        """The parts as they are now, of these clips or of all; nothing changes it later."""
        with self._lock:
            return self._rows.view(clip_ids)

    def _load(self, tx: Tx, clip_ids: Sequence[str]) -> None:
        vectors, spans = (arrays.get_many(tx, clip_ids, name) for name in self._names)
        # a clip of an earlier analysis has none until it is analysed again
        there = [clip_id for clip_id in clip_ids if clip_id in vectors and clip_id in spans]
        if there:
            self._rows.add(there, [vectors[i] for i in there], [spans[i] for i in there])


class SpanRows:
    """Columns that only grow, so that a view of them stays as it is; the dead are marked."""

    def __init__(self, width: int) -> None:
        self.width = width
        self.dead = 0
        self._number_of: dict[str, int] = {}
        self._ids, self._passing = Column(object), Column(np.bool_)
        self._firsts, self._counts = Column(np.int64), Column(np.int64)
        self.owners, self._squares = Column(np.int32), Column(np.float32)
        self._starts, self._ends = Column(np.float32), Column(np.float32)
        self._vectors = Column(np.float32, (width,))

    def by_row(self) -> tuple[Column, ...]:
        """The columns with an entry for each row."""
        return self.owners, self._starts, self._ends, self._vectors, self._squares

    def add(
        self, clip_ids: Sequence[str], vectors: Sequence[FloatArray], spans: Sequence[FloatArray]
    ) -> None:
        """Add clips that are not there, and the parts of each: (w, d) and (w, 2)."""
        numbers = np.arange(len(self._ids), len(self._ids) + len(clip_ids))
        self._number_of.update(zip(clip_ids, numbers.tolist(), strict=True))
        counts = np.array([len(one) for one in vectors])
        self._firsts.extend(len(self.owners) + np.cumsum(counts) - counts)
        self._counts.extend(counts)
        self._ids.extend(list(clip_ids))
        self._passing.extend(np.ones(len(clip_ids), dtype=bool))
        self.owners.extend(np.repeat(numbers, counts))
        starts, ends = np.concatenate(spans).T
        self._starts.extend(starts)
        self._ends.extend(ends)
        rows = np.concatenate(vectors).astype(np.float32)
        self._vectors.extend(rows)
        self._squares.extend(squared_lengths(rows))

    def remove(self, clip_ids: Iterable[str]) -> None:
        """Mark as dead those of the clips that are there."""
        numbers = [self._number_of.pop(i) for i in clip_ids if i in self._number_of]
        if numbers:
            self._passing = self._passing.apart()  # views that were taken keep theirs
            self._passing.view()[numbers] = False
            self.dead += int(self._counts.view()[numbers].sum())

    def view(self, clip_ids: Collection[str] | None = None) -> Spans:
        """As they are now, with the clips that are meant marked."""
        passing = self._passing.view()
        if clip_ids is not None:
            meant = [self._number_of[i] for i in clip_ids if i in self._number_of]
            passing = np.zeros(len(passing), dtype=bool)
            passing[meant] = True
        return Spans(
            ids=self._ids.view(),
            passing=passing,
            firsts=self._firsts.view(),
            counts=self._counts.view(),
            owners=self.owners.view(),
            starts=self._starts.view(),
            ends=self._ends.view(),
            vectors=self._vectors.view(),
            squares=self._squares.view(),
        )

    def without_the_dead(self) -> SpanRows:
        """The same with the living clips only, in their order."""
        now, living = self.view(), SpanRows(self.width)
        numbers, spans = np.flatnonzero(now.passing), np.stack([now.starts, now.ends], axis=1)
        for first in range(0, len(numbers), LOAD_BATCH):
            some = numbers[first : first + LOAD_BATCH]
            own = [slice(f, f + c) for f, c in zip(now.firsts[some], now.counts[some], strict=True)]
            living.add(
                now.ids[some].tolist(), [now.vectors[o] for o in own], [spans[o] for o in own]
            )
        return living
