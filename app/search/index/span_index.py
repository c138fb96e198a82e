"""The index over parts of clips: windows, or any others that an analysis stores.

A clip's parts are two arrays by name: vectors (w, d), and spans (w, 2), the start and end of
each in seconds, in order of start. They are kept as float32, clip after clip: 4 d + 16 bytes
a part. Nothing is loaded before the first search that asks.
"""

from __future__ import annotations

import threading
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.numerics.euclidean import squared_lengths
from app.search.index import usable_arrays
from app.search.index.labels import Column, Labels, LabelView
from app.search.ranking.ranking import IdArray
from app.store.clips import index_feed
from app.store.clips import versions as library
from app.store.clips.filter import ClipFilter
from app.store.clips.index_feed import IndexedClip
from app.store.database.engine import Tx
from app.store.store import Store

NO_FILTER = ClipFilter()

LOAD_BATCH = 64
"""Clips that are loaded at a time: an hour of motion has 3 MB of windows."""

FEW = 4
"""Where less than one row in so many passes, a view holds those alone."""

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

    def narrowed(self) -> Spans:
        """The same without the clips that do not pass, copied."""
        rows, clips = self.rows(), np.flatnonzero(self.passing)
        counts = self.counts[clips]
        return Spans(
            ids=self.ids[clips],
            passing=np.ones(len(clips), dtype=bool),
            firsts=np.cumsum(counts) - counts,
            counts=counts,
            owners=np.repeat(np.arange(len(clips)), counts),
            starts=self.starts[rows],
            ends=self.ends[rows],
            vectors=self.vectors[rows],
            squares=self.squares[rows],
        )

    def seconds(self) -> FloatArray:
        """(c,) where the last part of each clip ends; 0 for one that has none."""
        found = np.zeros(len(self.counts))
        has_parts = self.counts > 0
        found[has_parts] = self.ends[(self.firsts + self.counts - 1)[has_parts]]
        return found

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
            now = library.version(tx)
            if now != self._version:
                self._follow(tx)
                self._version = now
            return self._version

    def view(self, wanted: ClipFilter = NO_FILTER) -> Spans:
        """The parts as they are now, those of clips that pass marked; nothing changes it later."""
        with self._lock:
            now = self._rows.view()
        # not under the lock: a filter looks at every clip
        passing = now.labels.passing(wanted)
        spans = replace(now.spans, passing=passing)
        few = FEW * int(spans.counts[passing].sum()) < len(spans)
        return spans.narrowed() if few else spans

    def _follow(self, tx: Tx) -> None:
        self._rows.remove(library.buried_since(tx, self._version))
        for batch in index_feed.changed_since(tx, self._version, array=""):
            self._rows.remove([clip.id for clip in batch])
            ready = [clip for clip in batch if clip.is_ready]
            for first in range(0, len(ready), LOAD_BATCH):
                self._load(tx, ready[first : first + LOAD_BATCH])
        if self._rows.dead > MOST_DEAD * len(self):
            self._rows = self._rows.without_the_dead()

    def _load(self, tx: Tx, clips: Sequence[IndexedClip]) -> None:
        ids = [clip.id for clip in clips]
        vectors, spans = (usable_arrays.get_many(tx, ids, name) for name in self._names)
        # a clip of an earlier analysis may have none of this shape until it is analysed again
        there = [clip for clip in clips if clip.id in vectors and clip.id in spans]
        if there:
            self._rows.add(there, [vectors[c.id] for c in there], [spans[c.id] for c in there])


@dataclass(frozen=True, slots=True)
class SpanRowsView:
    """The parts at one moment, of all clips, and the clips' labels."""

    spans: Spans
    labels: LabelView


class SpanRows:
    """Columns that only grow, so that a view of them stays as it is; the dead are marked."""

    def __init__(self, width: int) -> None:
        self.width = width
        self.dead = 0
        self._labels = Labels()
        self._firsts, self._counts = Column(np.int64), Column(np.int64)
        self.owners, self._squares = Column(np.int32), Column(np.float32)
        self._starts, self._ends = Column(np.float32), Column(np.float32)
        self._vectors = Column(np.float32, (width,))

    def by_row(self) -> tuple[Column, ...]:
        """The columns with an entry for each row."""
        return self.owners, self._starts, self._ends, self._vectors, self._squares

    def add(
        self,
        clips: Sequence[IndexedClip],
        vectors: Sequence[FloatArray],
        spans: Sequence[FloatArray],
    ) -> None:
        """Add clips that are not there, and the parts of each: (w, d) and (w, 2)."""
        numbers = self._labels.used + np.arange(len(clips))
        self._labels.add(clips)
        counts = np.array([len(one) for one in vectors])
        self._firsts.extend(len(self.owners) + np.cumsum(counts) - counts)
        self._counts.extend(counts)
        self.owners.extend(np.repeat(numbers, counts))
        starts, ends = np.concatenate(spans).T
        self._starts.extend(starts)
        self._ends.extend(ends)
        rows = np.concatenate(vectors).astype(np.float32)
        self._vectors.extend(rows)
        self._squares.extend(squared_lengths(rows))

    def remove(self, clip_ids: Collection[str]) -> None:
        """Mark as dead those of the clips that are there."""
        numbers = [self._labels.number_of[i] for i in clip_ids if i in self._labels.number_of]
        self.dead += int(self._counts.view()[numbers].sum())
        self._labels.remove(clip_ids)

    def view(self) -> SpanRowsView:
        """As they are now, with all that are alive passing."""
        labels = self._labels.view()
        spans = Spans(
            ids=labels.ids,
            passing=labels.alive,
            firsts=self._firsts.view(),
            counts=self._counts.view(),
            owners=self.owners.view(),
            starts=self._starts.view(),
            ends=self._ends.view(),
            vectors=self._vectors.view(),
            squares=self._squares.view(),
        )
        return SpanRowsView(spans, labels)

    def without_the_dead(self) -> SpanRows:
        """The same with the living clips only, in their order."""
        now, living = self.view().spans, SpanRows(self.width)
        numbers, spans = np.flatnonzero(now.passing), np.stack([now.starts, now.ends], axis=1)
        for first in range(0, len(numbers), LOAD_BATCH):
            some = numbers[first : first + LOAD_BATCH].tolist()
            own = [slice(now.firsts[n], now.firsts[n] + now.counts[n]) for n in some]
            living.add(
                [self._labels.clip_at(n, None) for n in some],
                [now.vectors[o] for o in own],
                [spans[o] for o in own],
            )
        return living
