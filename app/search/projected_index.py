"""Exact search among the coordinates that a fitted model gives to the clips of an index.

Coordinates stand row beside row with those of the index, so that its labels filter both. They
are computed when a search first asks, then only for clips that came or changed since: this is
the out-of-sample extension, and the reason why searches need no refit. What the fit itself
computed is taken over when the model is first asked for.
"""

from __future__ import annotations

import threading
from collections import ChainMap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from app.numerics.arrays import FloatArray
from app.numerics.nearest import Block, squared_lengths
from app.search.index import VectorIndex
from app.search.labels import Column, Labels
from app.search.near import Near
from app.search.projections import Known, nothing_known
from app.search.rows import RowsView
from app.store.clip_filter import ClipFilter

BATCH = 2000
"""Clips whose coordinates are computed at a time; bounds what is read for them."""

Project = Callable[[Sequence[str]], Mapping[str, FloatArray]]
"""Coordinates (k,) by clip id; ids of clips that are gone are left out."""


class ProjectedIndex:
    """Coordinates of an index's clips, by one version of one model at a time."""

    def __init__(self, index: VectorIndex) -> None:
        self._index = index
        self._model = ""
        self._labels: Labels | None = None
        self._coordinates = Column(np.float32)
        self._squares = Column(np.float32)
        self._lock = threading.Lock()

    def nearest(
        self,
        model: str,
        project: Project,
        query: FloatArray,
        wanted: ClipFilter,
        exclude: frozenset[str] = frozenset(),
        known: Known = nothing_known,
    ) -> Near:
        """The clips that pass a filter, ranked by how far their coordinates are from `query` (k,).

        model: id of the model that `project`, `query` and what is `known` are of. The index has
        caught up.
        """
        version, rows = self._index.state
        block = self._beside(rows, model, project, known, len(query))
        passing = rows.labels.passing(wanted, exclude)
        return Near(version, replace(rows, blocks=(block,)), passing, query)

    def _beside(
        self, rows: RowsView, model: str, project: Project, known: Known, width: int
    ) -> Block:
        """Coordinates of all rows; 0 for those of clips that are gone."""
        ids, alive = rows.labels.ids, rows.labels.alive
        kept: dict[str, FloatArray] = {}
        with self._lock:
            if (self._model, self._labels) != (model, rows.labels.labels):
                self._model, self._labels = model, rows.labels.labels
                self._coordinates = Column(np.float32, (width,))
                self._squares = Column(np.float32)
                # Only now: what is known was so before any of these clips could change.
                kept = dict(zip(*known(), strict=True))
            for start in range(len(self._squares), len(ids), BATCH):
                batch = slice(start, start + BATCH)
                missing = [i for i in ids[batch][alive[batch]] if i not in kept]
                found = project(missing) if missing else {}
                rest = ChainMap(kept, dict(found))
                nothing = np.zeros(width)
                points = np.stack([rest.get(i, nothing) for i in ids[batch]]).astype(np.float32)
                self._coordinates.extend(points)
                self._squares.extend(squared_lengths(points))
            count = len(ids)
            return Block(self._coordinates.view()[:count], self._squares.view()[:count])
