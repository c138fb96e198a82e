"""What a fitted model makes of each clip, row beside row with an index of clips.

So an index's labels filter both, and no clip is looked up by its id when a search asks. Rows
are computed when a search first asks, then only of clips that came or changed since: this is
the out-of-sample extension of every model, and the reason why searches need no refit. What the
fit itself computed is taken over when the model is first asked for.
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
"""Clips that are computed at a time; bounds what is read for them."""

Compute = Callable[[Sequence[str]], Mapping[str, FloatArray]]
"""Rows (width,) by clip id; ids of clips that are gone are left out."""

Known = Callable[[], tuple[Sequence[str], FloatArray]]
"""Ids (n) and rows (n, width) that were computed with the model and still hold."""


def nothing_known() -> tuple[Sequence[str], FloatArray]:
    """Of models that keep no rows."""
    return (), np.zeros((0, 0))


@dataclass(frozen=True, slots=True)
class ModelRowsView:
    """Rows of a model for the n clips of an index at one moment.

    values: (n, width) float32, 0 where nothing could be computed; there: (n,) whether it could;
    series: the same object as long as values are only added behind those that were there.
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
        self._lock = threading.Lock()

    def of(
        self,
        clips: LabelView,
        model: str,
        width: int,
        compute: Compute,
        known: Known = nothing_known,
    ) -> ModelRowsView:
        """The rows of all clips of an index, always the same one.

        model: id of the model that `compute` and what is `known` are of.
        """
        ids, alive = clips.ids, clips.alive
        with self._lock:
            if (self._model, self._labels) != (model, clips.labels):
                # Only now: what is known was so before any of these clips could change.
                self._kept = dict(zip(*known(), strict=True))
                self._kept_for = len(ids)
                self._model, self._labels = model, clips.labels
                self._values = Column(np.float32, (width,))
                self._there = Column(np.bool_)
            while (start := len(self._there)) < len(ids):
                # What is known holds for the clips that were there then, not for later ones. It
                # is kept until they are done: a request may stop half-way, when its time is up.
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
            values, there = self._values.view()[: len(ids)], self._there.view()[: len(ids)]
            return ModelRowsView(values, there, self._values)
