"""The rows that a fitted model computes for the clips of an index, in the order of the index.

So the labels of the index filter these rows too, and a search needs no lookup by clip id. The first
search computes the rows of all clips. Later searches compute only the rows of new and changed
clips. So a new clip is found without a new fit. The rows that the fit computed are used when a
search uses the model for the first time. A search takes a lock only while rows are missing.
"""

from __future__ import annotations

import threading
from collections import ChainMap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from app.numerics.arrays import BoolArray, FloatArray
from app.search.index.column import Column
from app.search.index.labels import Labels, LabelView

BATCH = 2000
"""Number of clips whose rows are computed at a time. It bounds the memory for their arrays."""

Compute = Callable[[Sequence[str]], Mapping[str, FloatArray]]
"""A function from clip ids to rows (width,) by clip id; deleted clips are left out."""

FittedRows = Callable[[], tuple[Sequence[str], FloatArray]]
"""A function that returns clip ids (n) and rows (n, width) that the fit computed.

Clips that changed since the fit are left out."""


def no_fitted_rows() -> tuple[Sequence[str], FloatArray]:
    """The rows of a model that stored no rows when it was fitted."""
    return (), np.zeros((0, 0))


@dataclass(frozen=True, slots=True)
class ModelRowsView:
    """Rows of a model for the n clips of an index at one moment.

    values: (n, width) float32, 0 for clips without a row; has_row: (n,) whether a clip has a row;
    series: the same object as long as values are only added at the end.
    """

    values: FloatArray
    has_row: BoolArray
    series: object


class ModelRows:
    """Rows (width,) float32 of an index's clips, by one version of one model at a time."""

    def __init__(self) -> None:
        self._model = ""
        self._labels: Labels | None = None
        self._values = Column(np.float32)
        self._has_row = Column(np.bool_)
        self._fitted: dict[str, FloatArray] = {}
        self._fitted_clips = 0
        self._done: tuple[str, Labels, ModelRowsView] | None = None
        self._lock = threading.Lock()

    def of(
        self,
        clips: LabelView,
        model: str,
        width: int,
        compute: Compute,
        fitted: FittedRows = no_fitted_rows,
    ) -> ModelRowsView:
        """The rows of all clips in a view of an index, which must always be the same index.

        model: the id of the model. width: of a row. compute: computes rows of the model. fitted:
        the rows that the fit of the model computed.
        """
        return self._finished(clips, model) or self._completed(clips, model, width, compute, fitted)

    def _finished(self, clips: LabelView, model: str) -> ModelRowsView | None:
        """The rows, if all of them were computed; else None. This needs no lock."""
        done, count = self._done, len(clips.ids)
        if done is None or done[:2] != (model, clips.labels) or len(done[2].has_row) < count:
            return None
        return ModelRowsView(done[2].values[:count], done[2].has_row[:count], done[2].series)

    def _completed(
        self, clips: LabelView, model: str, width: int, compute: Compute, fitted: FittedRows
    ) -> ModelRowsView:
        """The rows, after the missing rows were computed."""
        ids, alive = clips.ids, clips.alive
        with self._lock:
            if (self._model, self._labels) != (model, clips.labels):
                # Read now: the rows are valid only until one of these clips changes.
                self._fitted = dict(zip(*fitted(), strict=True))
                self._fitted_clips = len(ids)
                self._model, self._labels = model, clips.labels
                self._values = Column(np.float32, (width,))
                self._has_row = Column(np.bool_)
            while (start := len(self._has_row)) < len(ids):
                # The fitted rows belong to the clips of the first search, not to later clips. They
                # stay until these clips are done, because a request may stop at its deadline.
                fitted_rows = self._fitted if start < self._fitted_clips else {}
                stop = min(start + BATCH, self._fitted_clips if fitted_rows else len(ids))
                batch = slice(start, stop)
                missing = [i for i in ids[batch][alive[batch]] if i not in fitted_rows]
                rows = ChainMap(fitted_rows, dict(compute(missing)) if missing else {})
                no_row = np.zeros(width)
                self._values.extend(np.stack([rows.get(i, no_row) for i in ids[batch]]))
                self._has_row.extend([i in rows for i in ids[batch]])
            if len(self._has_row) >= self._fitted_clips:
                self._fitted = {}
            view = ModelRowsView(self._values.view(), self._has_row.view(), self._values)
            self._done = model, clips.labels, view
            return ModelRowsView(view.values[: len(ids)], view.has_row[: len(ids)], view.series)
