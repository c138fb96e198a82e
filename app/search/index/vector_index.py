"""The index: the vectors of all ready clips in memory, and exact search among them.

The same class is used for motion vectors (one row for each clip), and for poses, windows and
segments (several rows for each clip); see `Layout`. An index follows the version of the library:
`catch_up` reads the version, and loads the clips that changed. It takes a lock only if the version
has changed. Each search reads its own `RowsView`, also while changes are loaded.
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
PACED = "paced_vector"
PACED_VECTORS = Layout((PACED,), WIDTH)

JOIN_BATCH = 64
"""Number of clips whose arrays are in memory at a time while they are joined. An hour of motion has
3 MB of windows."""


@dataclass(frozen=True, slots=True)
class Candidates:
    """Clips that passed a filter, in the index's order.

    version: of the library; ids: (n,); seconds: (n,) the durations of the clips.
    """

    version: int
    ids: IdArray
    seconds: FloatArray


class VectorIndex:
    """The float32 vectors of the ready clips, and the labels that filters need."""

    def __init__(
        self,
        on_change: Callable[[tuple[str, ...]], None] | None = None,
        layout: Layout = MOTION_VECTORS,
    ) -> None:
        """on_change: is called with the ids of changed and deleted clips. layout: of the rows."""
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
        """Whether the library was loaded at least once."""
        return self._loaded

    @property
    def version(self) -> int:
        """The library version of the clips in the index."""
        return self._state[0]

    @property
    def state(self) -> tuple[int, RowsView]:
        """The library version and the rows at that version."""
        return self._state

    def catch_up(self, store: Store) -> int:
        """Load all changes up to the present version of the library, and return this version.

        Without changes, this is one cheap query.
        """
        with store.read() as tx:
            if self._loaded and library.version(tx) == self.version:
                return self.version
        with self._lock, store.read() as tx:
            # Another thread may have loaded the changes while this one waited for the lock.
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
        """Load the changes up to version `now`. Searches see all changes at once, at the end."""
        since = self.version
        if self._loaded:
            self._forget(library.deleted_since(tx, since))
        else:
            self._rows = Rows(self._layout)  # an earlier load may have failed halfway
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
    """The clips with their named arrays side by side.

    The array is None if one of the arrays is missing, or if their lengths differ.
    """
    ids = [clip.id for clip in clips if clip.is_ready]
    arrays = [usable_arrays.get_many(tx, ids, name) for name in names]
    joined = []
    for clip in clips:
        own = [by_id[clip.id] for by_id in arrays if clip.id in by_id]
        is_whole = len(own) == len(names) and len({len(array) for array in own}) == 1
        joined.append(replace(clip, array=np.hstack(own) if is_whole else None))
    return joined
