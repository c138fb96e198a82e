"""The scores that a fitted model computes for the parts in an index, in the order of its rows.

The first search after a fit computes the scores of all parts. Later searches compute only those of
parts that were added. A search takes a lock only while scores are missing.
"""

from __future__ import annotations

import threading
from collections.abc import Callable

import numpy as np

from app.deadline import check
from app.numerics.arrays import FloatArray
from app.search.index.column import Column
from app.search.index.labels import Labels
from app.search.index.rows import RowsView

BATCH = 4096
"""The number of parts whose scores are computed at a time."""

Predict = Callable[[FloatArray], FloatArray]
"""A function from the vectors of parts (k, width) to their scores (k, columns)."""


class PartScores:
    """Scores (columns,) float32 of an index's parts, by one version of one model at a time."""

    def __init__(self) -> None:
        self._model = ""
        self._labels: Labels | None = None
        self._scores = Column(np.float32)
        self._lock = threading.Lock()

    def of(self, view: RowsView, model: str, columns: int, predict: Predict) -> FloatArray:
        """(rows, columns) the scores of all parts in a view of an index, always the same index.

        model: the id of the model; predict: computes its scores.
        """
        count = 0 if view.owners is None else len(view.owners)
        with self._lock:
            # An index whose dead rows were dropped has other labels, and its rows have moved.
            if (self._model, self._labels) != (model, view.labels.labels):
                self._model, self._labels = model, view.labels.labels
                self._scores = Column(np.float32, (columns,))
            while (start := len(self._scores)) < count:
                check()
                rows = np.arange(start, min(start + BATCH, count))
                self._scores.extend(predict(view.vectors(rows)))
            return self._scores.view()[:count]
