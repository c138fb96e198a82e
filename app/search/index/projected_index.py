"""Exact search among the coordinates that a fitted model computes for the clips of an index."""

from __future__ import annotations

import threading
from dataclasses import replace

import numpy as np

from app.numerics.arrays import FloatArray
from app.numerics.nearest import Block, squared_lengths
from app.search.index.column import Column
from app.search.index.model_rows import (
    Compute,
    FittedRows,
    ModelRows,
    ModelRowsView,
    no_fitted_rows,
)
from app.search.index.nearest_ranking import NearestRanking
from app.search.index.rows import RowsView
from app.search.index.vector_index import VectorIndex
from app.store.clips.filter import ClipFilter


class ProjectedIndex:
    """Coordinates of an index's clips, by one version of one model at a time."""

    def __init__(self, index: VectorIndex) -> None:
        self._index = index
        self._coordinates = ModelRows()
        self._column = Column(np.float32)
        self._squares: tuple[object, FloatArray] = None, self._column.view()
        self._lock = threading.Lock()

    def nearest(
        self,
        model: str,
        project: Compute,
        query: FloatArray,
        clip_filter: ClipFilter,
        exclude: frozenset[str] = frozenset(),
        fitted: FittedRows = no_fitted_rows,
    ) -> NearestRanking:
        """The clips that pass a filter, ranked by the distance of their coordinates to a query.

        query: (k,) coordinates. model: the id of the model. project: computes coordinates by the
        model. fitted: the coordinates that its fit computed. Call `catch_up` of the index before.
        """
        version, rows = self._index.state
        rows = self.rows(rows, model, len(query), project, fitted)
        return NearestRanking(version, rows, rows.labels.mask(clip_filter, exclude), query)

    def rows(
        self,
        rows: RowsView,
        model: str,
        width: int,
        project: Compute,
        fitted: FittedRows = no_fitted_rows,
    ) -> RowsView:
        """The clips of a view of the index, with their coordinates (width,) as vectors.

        model, project, fitted: as in `nearest`.
        """
        coordinates = self._coordinates.of(rows.labels, model, width, project, fitted)
        return replace(rows, blocks=(self._block(coordinates),))

    def _block(self, coordinates: ModelRowsView) -> Block:
        """The coordinates of all clips as a block; 0 for clips without coordinates."""
        count = len(coordinates.values)
        series, squares = self._squares
        if series is not coordinates.series or len(squares) < count:
            squares = self._add_squares(coordinates)
        return Block(coordinates.values, squares[:count])

    def _add_squares(self, coordinates: ModelRowsView) -> FloatArray:
        """The squared lengths of these coordinates; only those of new clips are computed."""
        with self._lock:
            if self._squares[0] is not coordinates.series:
                self._column = Column(np.float32)
            self._column.extend(squared_lengths(coordinates.values[len(self._column) :]))
            self._squares = coordinates.series, self._column.view()
            return self._squares[1]
