"""Parts of clips (windows or segments) in an index: their times and their vectors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.numerics.arrays import FloatArray, IntArray
from app.search.index.rows import Layout, RowsView
from app.search.ranking.ranking import IdArray
from app.store.clips.filter import ClipFilter

NO_FILTER = ClipFilter()

MAX_DEAD = 0.25
"""Largest share of dead rows. It is small because parts take more memory than other rows."""


def parts_layout(vectors: str, spans: str, width: int) -> Layout:
    """The layout of an index of parts, which are stored in two arrays, in order of start.

    vectors: name of the array (w, width) of vectors; spans: name of the array (w, 2) of the start
    and end of each part in seconds.
    """
    return Layout((spans, vectors), width, facts=2, several=True, max_dead=MAX_DEAD)


@dataclass(frozen=True, slots=True)
class Parts:
    """The k parts of the clips that pass a filter, clip by clip, in order of start.

    ids: (c,) ids of all clips; rows: (k,) rows of the index; owners: (k,) numbers 0..c-1 of the
    clips, ascending; starts, ends: (k,) float32 seconds.
    """

    view: RowsView
    ids: IdArray
    rows: IntArray
    owners: IntArray
    starts: FloatArray
    ends: FloatArray

    @classmethod
    def of(cls, view: RowsView, clip_filter: ClipFilter = NO_FILTER) -> Parts:
        """The parts in a view of an index with a `parts_layout`.

        Raises ValueError for an index with another layout.
        """
        if view.owners is None:
            raise ValueError("an index of parts has several rows for each clip")
        rows = np.flatnonzero(view.rows_of(view.labels.mask(clip_filter)))
        # `take` is many times as fast as an index in brackets.
        starts, ends = np.ascontiguousarray(view.facts.take(rows, axis=0).T)
        return cls(view, view.labels.ids, rows, view.owners.take(rows), starts, ends)

    def __len__(self) -> int:
        return len(self.rows)

    def distances(self, queries: FloatArray) -> FloatArray:
        """(q, k) float32 Euclidean distances of `queries` (q, width) to the parts."""
        return self.view.distances(queries, self.rows)

    def last_parts(self) -> IntArray:
        """(k,) for each part the index of the last part of the same clip."""
        lasts = self._lasts()
        return np.repeat(lasts, np.diff(lasts, prepend=-1))

    def seconds(self) -> FloatArray:
        """(c,) the end of the last part of each clip; 0 for a clip without parts."""
        ends = np.zeros(len(self.ids))
        lasts = self._lasts()
        ends[self.owners[lasts]] = self.ends[lasts]
        return ends

    def _lasts(self) -> IntArray:
        """(m,) the index of the last part of each clip that has parts."""
        ends = np.flatnonzero(self.owners[1:] != self.owners[:-1])
        return np.append(ends, len(self) - 1) if len(self) else ends
