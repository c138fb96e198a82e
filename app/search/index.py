"""The index: every ready clip's motion vector in memory, exact search by one BLAS product.

It follows the library version: `catch_up` reads one number and loads what changed since.
A lock makes it safe to share between threads; it is held for milliseconds.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from app.numerics.arrays import FloatArray, IntArray
from app.search.rank import IdArray
from app.search.rows import Rows
from app.store import arrays, clips, library
from app.store.clip_filter import ClipFilter
from app.store.engine import Tx
from app.store.store import Store

VECTOR = "motion_vector"
WIDTH = 128
LOAD_BATCH = 5000
"""Clips loaded at a time, so that a first load does not hold the library twice."""
EXACT = 1000
"""So many of the nearest are measured again without the rounding of the product."""


@dataclass(frozen=True, slots=True)
class Candidates:
    """Clips that passed a filter, in the index's order: ids (n,), distances (n,) or empty."""

    version: int
    ids: IdArray
    distances: FloatArray


class VectorIndex:
    """Motion vectors (n, 128) float32 of the ready clips, with the labels that filters need."""

    def __init__(self, on_change: Callable[[tuple[str, ...]], None] | None = None) -> None:
        """`on_change` is told the ids of clips that changed or went."""
        self._on_change = on_change
        self._rows = Rows(WIDTH)
        self._version = 0
        self._loaded = False
        self._lock = threading.Lock()

    def __len__(self) -> int:
        return self._rows.count

    @property
    def is_loaded(self) -> bool:
        """Whether it has caught up with the library once."""
        return self._loaded

    @property
    def version(self) -> int:
        """The library version that it stands at."""
        return self._version

    def catch_up(self, store: Store) -> int:
        """Bring the index to the library's version and return that.

        One cheap query when nothing is new.
        """
        with self._lock, store.read() as tx:
            changes = library.changed_since(tx, self._version)
            for clip_id in changes.removed:
                self._rows.remove(clip_id)
            for start in range(0, len(changes.changed), LOAD_BATCH):
                self._load(tx, changes.changed[start : start + LOAD_BATCH])
            if self._on_change and (touched := changes.changed + changes.removed):
                self._on_change(touched)
            self._version, self._loaded = changes.version, True
            return self._version

    def candidates(self, wanted: ClipFilter, exclude: frozenset[str] = frozenset()) -> Candidates:
        """The clips that pass a filter, without distances."""
        with self._lock:
            rows = self._rows.passing(wanted, exclude)
            return Candidates(self._version, self._rows.ids[rows], np.zeros(0))

    def nearest(
        self, query: FloatArray, wanted: ClipFilter, exclude: frozenset[str] = frozenset()
    ) -> Candidates:
        """The clips that pass a filter with their Euclidean distances to `query` (128,)."""
        with self._lock:
            rows = self._rows.passing(wanted, exclude)
            distances = self._distances(np.asarray(query, dtype=np.float32), rows)
            return Candidates(self._version, self._rows.ids[rows], distances)

    def labels(self, clip_id: str) -> frozenset[str]:
        """The words of a clip that is in the index."""
        with self._lock:
            words: frozenset[str] = self._rows.words[self._rows.row_of[clip_id]]
            return words

    def _load(self, tx: Tx, clip_ids: tuple[str, ...]) -> None:
        vectors = arrays.get_many(tx, clip_ids, VECTOR)
        for clip in clips.get_many(tx, clip_ids).values():
            self._rows.put(clip, vectors[clip.id])

    def _distances(self, query: FloatArray, rows: IntArray) -> FloatArray:
        """(n,) float64: |q - x|, by |q|^2 - 2 q.x + |x|^2, the nearest again without rounding."""
        if not len(rows):
            return np.zeros(0)
        count = self._rows.count
        # One product over all rows is faster than gathering the few that a filter leaves.
        products = (self._rows.vectors[:count] @ query)[rows].astype(np.float64)
        squares = self._rows.squares[rows] + float(query @ query) - 2.0 * products
        distances = np.sqrt(np.maximum(squares, 0.0))
        near = np.argsort(distances, kind="stable")[:EXACT]
        far = np.ones(len(rows), dtype=bool)
        far[near] = False
        difference = self._rows.vectors[rows[near]].astype(np.float64) - query
        distances[near] = np.linalg.norm(difference, axis=1)
        # What was not measured again must not overtake what was.
        distances[far] = np.maximum(distances[far], distances[near].max())
        return np.asarray(distances)
