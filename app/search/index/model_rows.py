"""The rows that a fitted model computes for the clips of an index, in the index's own order.

So the labels of the index filter these rows too, and a search looks no clip up by its id. Rows are
computed when a search first asks for them, and then only for clips that came or changed since. This
is the out-of-sample extension of every model: searches need no new fit. Rows that the fit computed
are taken over when the model is first used. A search takes a lock only while rows are missing.
"""

from __future__ import annotations

import threading
from collections import ChainMap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from app.numerics.arrays import BoolArray, FloatArray
from app.search.index.labels import Column, Labels, LabelView

BATCH = 2000
"""Clips that are computed at a time; this bounds the memory for what is read of them."""

Compute = Callable[[Sequence[str]], Mapping[str, FloatArray]]
"""Rows (width,) by clip id; clips that are gone are left out."""

FittedRows = Callable[[], tuple[Sequence[str], FloatArray]]
"""Ids (n) and rows (n, width) that the fit of the model computed and that are still right."""


def no_fitted_rows() -> tuple[Sequence[str], FloatArray]:
    """The rows of a model that keeps none."""
    return (), np.zeros((0, 0))


@dataclass(frozen=True, slots=True)
class ModelRowsView:
    """Rows of a model for the n clips of an index at one moment.

    values: (n, width) float32, 0 where nothing could be computed; there: (n,) whether it could;
    series: the same object as long as values are only added at the end.
    """

    values: FloatArray
    there: BoolArray
    series: object


class ModelRows:
    """Rows (width,) float32 of an index's clips, by one version of one model at a time."""

    def __init__(self) -> None:
        self._model = ""
        self._labels: Labels | None = None
        self._values = Column(np.float32)
        self._there = Column(np.bool_)
        self._kept: dict[str, FloatArray] = {}
        self._kept_for = 0
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
        """The rows of all clips of an index, always the same one.

        model: id of the model that `compute` and `fitted` belong to.
        """
        return self._finished(clips, model) or self._completed(clips, model, width, compute, fitted)

    def _finished(self, clips: LabelView, model: str) -> ModelRowsView | None:
        """The rows if all of them are there; read without a lock."""
        done, count = self._done, len(clips.ids)
        if done is None or done[:2] != (model, clips.labels) or len(done[2].there) < count:
            return None
        return ModelRowsView(done[2].values[:count], done[2].there[:count], done[2].series)

    def _completed(
        self, clips: LabelView, model: str, width: int, compute: Compute, fitted: FittedRows
    ) -> ModelRowsView:
        """The rows, those that are missing computed."""
        ids, alive = clips.ids, clips.alive
        with self._lock:
            if (self._model, self._labels) != (model, clips.labels):
                # Not later: these rows are right only until one of these clips changes.
                self._kept = dict(zip(*fitted(), strict=True))
                self._kept_for = len(ids)
                self._model, self._labels = model, clips.labels
                self._values = Column(np.float32, (width,))
                self._there = Column(np.bool_)
            while (start := len(self._there)) < len(ids):
                # The known rows belong to the clips that were there then, not to later ones. They
                # are kept until those clips are done: a request may stop when its time is up.
                kept = self._kept if start < self._kept_for else {}
                stop = min(start + BATCH, self._kept_for if kept else len(ids))
                batch = slice(start, stop)
                missing = [i for i in ids[batch][alive[batch]] if i not in kept]
                found = ChainMap(kept, dict(compute(missing)) if missing else {})
                nothing = np.zeros(width)
                self._values.extend(np.stack([found.get(i, nothing) for i in ids[batch]]))
                self._there.extend([i in found for i in ids[batch]])
            if len(self._there) >= self._kept_for:
                self._kept = {}
            every = ModelRowsView(self._values.view(), self._there.view(), self._values)
            self._done = model, clips.labels, every
            return ModelRowsView(every.values[: len(ids)], every.there[: len(ids)], every.series)
