"""The index: every ready clip's vectors in memory, and exact search over them.

One class serves all that is searched in memory: motion vectors (one row a clip), and poses, windows
and segments (several rows a clip); see `Layout`. An index follows the library's version: `catch_up`
reads one number and loads what changed since. It takes a lock only where something changed. Each
search reads its own `RowsView`, while changes are loaded at the same time.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.numerics.arrays import FloatArray
from app.search.index import usable_arrays
from app.search.index.nearest_ranking import NearestRanking
from app.search.index.rows import Layout, Rows, RowsView
from app.search.ranking.ranking import IdArray
from app.store.clips import index_feed
from app.store.clips import versions as library
from app.store.clips.filter import ClipFilter
from app.store.clips.index_feed import IndexedClip
from app.store.database.engine import Tx
from app.store.store import Store

VECTOR = "motion_vector"
WIDTH = 128
MOTION_VECTORS = Layout((VECTOR,), WIDTH)

JOIN_BATCH = 64
"""Clips whose arrays are held at a time while several are joined: an hour of motion has 3 MB of
windows."""


@dataclass(frozen=True, slots=True)
class Candidates:
    """Clips that passed a filter, in the index's order.

    version: of the library; ids: (n,); seconds: (n,) how long the clips are.
    """

    version: int
    ids: IdArray
    seconds: FloatArray


class VectorIndex:
    """Vectors float32 of the ready clips, with the labels that filters need."""

    def __init__(
        self,
        on_change: Callable[[tuple[str, ...]], None] | None = None,
        layout: Layout = MOTION_VECTORS,
    ) -> None:
        """on_change: gets the ids of clips that changed or are gone; layout: what is kept."""
        self._on_change = on_change
        self._layout = layout
        self._rows = Rows(layout)
        self._state = 0, self._rows.view()
        self._loaded = False
        self._lock = threading.Lock()

    def __len__(self) -> int:
        return len(self._rows)

    @property
    def is_loaded(self) -> bool:
        """Whether the library was loaded once."""
        return self._loaded

    @property
    def version(self) -> int:
        """The library version whose clips it holds."""
        return self._state[0]

    @property
    def state(self) -> tuple[int, RowsView]:
        """The library version and the rows at that version."""
        return self._state

    def catch_up(self, store: Store) -> int:
        """Bring the index to the library's version and return that.

        One cheap query when nothing is new.
        """
        with store.read() as tx:
            if self._loaded and library.version(tx) == self.version:
                return self.version
        with self._lock, store.read() as tx:
            now = library.version(tx)
            if not self._loaded or now != self.version:
                self._follow(tx, now)
            return now

    def candidates(
        self, clip_filter: ClipFilter, exclude: frozenset[str] = frozenset()
    ) -> Candidates:
        """The clips that pass a filter, without distances."""
        version, rows = self._state
        labels = rows.labels
        mask = labels.mask(clip_filter, exclude)
        return Candidates(version, labels.ids[mask], labels.durations[mask])

    def nearest(
        self, query: FloatArray, clip_filter: ClipFilter, exclude: frozenset[str] = frozenset()
    ) -> NearestRanking:
        """The clips that pass a filter, ranked by Euclidean distance to `query` (width,)."""
        version, rows = self._state
        return NearestRanking(version, rows, rows.labels.mask(clip_filter, exclude), query)

    def _follow(self, tx: Tx, now: int) -> None:
        """Load what changed up to version `now`; searches see all changes together, at the end."""
        since = self.version
        if self._loaded:
            self._forget(library.buried_since(tx, since))
        else:
            self._rows = Rows(self._layout)  # a load that failed half-way may have left some
        for batch in self._changed(tx, since):
            ready = [clip for clip in batch if clip.is_ready]
            self._forget(tuple(clip.id for clip in batch if not clip.is_ready))
            self._rows.put(ready)
            self._report(tuple(clip.id for clip in ready))
        if self._rows.is_wasteful:
            self._rows = self._rows.living()
        self._state = now, self._rows.view()
        self._loaded = True

    def _changed(self, tx: Tx, since: int) -> Iterator[Sequence[IndexedClip]]:
        """The clips that changed after version `since`, each with the array of its rows."""
        names = self._layout.arrays
        if len(names) == 1:
            yield from index_feed.changed_since(tx, since, names[0])
            return
        for batch in index_feed.changed_since(tx, since, array=""):
            for first in range(0, len(batch), JOIN_BATCH):
                yield _joined(tx, batch[first : first + JOIN_BATCH], names)

    def _forget(self, clip_ids: tuple[str, ...]) -> None:
        self._rows.remove(clip_ids)
        self._report(clip_ids)

    def _report(self, clip_ids: tuple[str, ...]) -> None:
        if clip_ids and self._on_change:
            self._on_change(clip_ids)


def _joined(tx: Tx, clips: Sequence[IndexedClip], names: Sequence[str]) -> list[IndexedClip]:
    """The clips with their named arrays side by side; None where one is missing or too short."""
    ids = [clip.id for clip in clips if clip.is_ready]
    arrays = [usable_arrays.get_many(tx, ids, name) for name in names]
    found = []
    for clip in clips:
        own = [by_id[clip.id] for by_id in arrays if clip.id in by_id]
        is_whole = len(own) == len(names) and len({len(array) for array in own}) == 1
        found.append(replace(clip, array=np.hstack(own) if is_whole else None))
    return found
