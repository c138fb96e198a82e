"""Described motions as a search sees them: an index of vectors, and arrays to load."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any, cast

import numpy as np

from app.numerics.arrays import FloatArray
from app.search.example.by_example import rank_by_example
from app.search.example.distances import Descriptors
from app.search.example.methods import Method
from app.search.index.nearest_ranking import NearestRanking
from app.search.index.rows import Rows, RowsView
from app.search.index.vector_index import MOTION_VECTORS, PACED, VECTOR, VectorIndex
from app.search.ranking.cursor import Anchor
from app.search.ranking.ranking import Ranked
from app.store.clips.filter import ClipFilter
from tests.search.indexed import indexed

Arrays = Mapping[str, FloatArray]


class LocalLibrary:
    """n motions by id, their arrays by name."""

    def __init__(self, clips: Mapping[str, Arrays]) -> None:
        self.clips = clips
        self.read: list[tuple[str, str]] = []
        """(clip id, array name) of all arrays that were loaded."""

    def rank(
        self,
        query: Descriptors,
        method: Method,
        *,
        is_any_tempo: bool = True,
        exclude: frozenset[str] = frozenset(),
        anchor: Anchor | None = None,
    ) -> Ranked:
        """All motions but `exclude` in the order of a search."""
        paced = self._paced if is_any_tempo else None
        return rank_by_example(
            self._vectors, query, method, ClipFilter(), exclude, self._load, anchor, paced
        )

    def _load(self, clip_ids: Sequence[str], name: str) -> Arrays:
        self.read.extend((clip_id, name) for clip_id in clip_ids)
        return {i: self.clips[i][name] for i in clip_ids if name in self.clips[i]}

    @cached_property
    def _vectors(self) -> VectorIndex:
        return self._index(VECTOR)

    @cached_property
    def _paced(self) -> VectorIndex:
        return self._index(PACED)

    def _index(self, name: str) -> VectorIndex:
        rows = Rows(MOTION_VECTORS)
        rows.put([indexed(i, arrays[name]) for i, arrays in self.clips.items() if name in arrays])
        return cast("VectorIndex", _Index(rows.view()))


class _Index:
    def __init__(self, rows: RowsView) -> None:
        self._rows = rows

    def nearest(self, query: FloatArray, clip_filter: ClipFilter, exclude: Any) -> NearestRanking:
        mask = self._rows.labels.mask(clip_filter, exclude)
        return NearestRanking(1, self._rows, mask, np.asarray(query, dtype=np.float32))

    def candidates(self, clip_filter: ClipFilter, exclude: Any) -> Any:
        labels = self._rows.labels
        mask = labels.mask(clip_filter, exclude)
        return _Candidates(labels.ids[mask])


class _Candidates:
    def __init__(self, ids: Any) -> None:
        self.ids = ids
