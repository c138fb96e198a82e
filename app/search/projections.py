"""What a fitted model makes of each clip, kept so that only new clips are computed.

A clip that becomes ready after the fit is projected when it is first asked for: this is
the out-of-sample extension of every model, and the reason why searches need no refit. What
the fit itself computed is taken over when the model is first asked for.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Sequence
from itertools import repeat

import numpy as np

from app.numerics.arrays import FloatArray, IntArray
from app.search.labels import Column

Compute = Callable[[list[str]], dict[str, FloatArray]]
"""Projects clips: ids -> (width,) by id; ids of clips that are gone are left out."""

Known = Callable[[], tuple[Sequence[str], FloatArray]]
"""Ids (n) and rows (n, width) that were computed with the model and still hold."""

WASTED = 1000
"""Rows of changed clips that may lie idle besides as many as are in use."""


def nothing_known() -> tuple[Sequence[str], FloatArray]:
    """Of models that keep no rows."""
    return (), np.zeros((0, 0))


class Projections:
    """Rows (width,) float32 by clip id, of one version of one model at a time."""

    def __init__(self) -> None:
        self._model = ""
        self._row_of: dict[str, int] = {}
        self._rows = Column(np.float32, (0,))
        self._forgotten = 0
        self._lock = threading.Lock()

    def of(
        self,
        model: str,
        clip_ids: Sequence[str],
        compute: Compute,
        known: Known = nothing_known,
        columns: Sequence[int] | None = None,
    ) -> tuple[list[str], FloatArray]:
        """The ids that exist and their rows (n, width), by the model with that id.

        columns: the entries of a row that are wanted, all by default.
        """
        with self._lock:
            self._turn_to(model, known)
            forgotten = self._forgotten
            places = self._places(clip_ids)
            rows = self._rows.view()
        missing = [clip_ids[place] for place in np.flatnonzero(places < 0)]
        if missing:
            computed = compute(missing)
            self._keep(model, computed, forgotten)
            there = [i for i, at in zip(clip_ids, places, strict=True) if at >= 0 or i in computed]
            found = _joined(rows, places, computed, clip_ids)
            return there, found if columns is None or not there else found[:, columns]
        return list(clip_ids), _taken(rows, places, columns)

    def forget(self, clip_ids: Iterable[str]) -> None:
        """Drop the rows of clips that changed."""
        with self._lock:
            self._forgotten += 1
            for clip_id in clip_ids:
                self._row_of.pop(clip_id, None)

    def _turn_to(self, model: str, known: Known) -> None:
        if self._model != model:
            # Under the lock, so that a change that comes meanwhile is forgotten afterwards.
            ids, rows = known()
            self._model, self._row_of = model, {}
            self._rows = Column(np.float32, (0,))
            self._extend(ids, rows)

    def _places(self, clip_ids: Sequence[str]) -> IntArray:
        """(n,) where their rows are, -1 where there is none."""
        found = map(self._row_of.get, clip_ids, repeat(-1))
        return np.fromiter(found, dtype=np.int64, count=len(clip_ids))

    def _keep(self, model: str, computed: dict[str, FloatArray], forgotten: int) -> None:
        with self._lock:
            # Unless something changed meanwhile: then what was computed may be old.
            if computed and (model, forgotten) == (self._model, self._forgotten):
                self._extend(tuple(computed), np.stack(list(computed.values())))

    def _extend(self, ids: Sequence[str], rows: FloatArray) -> None:
        if not ids:
            return
        if not self._row_of or len(self._rows) > 2 * len(self._row_of) + WASTED:
            kept = self._rows.view()[list(self._row_of.values())]
            self._rows = Column(np.float32, (rows.shape[1],))
            self._row_of = {clip_id: row for row, clip_id in enumerate(self._row_of)}
            if self._row_of:
                self._rows.extend(kept)
        first = len(self._rows)
        self._rows.extend(rows)
        self._row_of.update(zip(ids, range(first, first + len(ids)), strict=True))


def _taken(rows: FloatArray, places: IntArray, columns: Sequence[int] | None) -> FloatArray:
    if columns is None:
        return rows[places]
    return rows[places[:, None], np.asarray(columns, dtype=np.int64)]


def _joined(
    rows: FloatArray,
    places: IntArray,
    computed: dict[str, FloatArray],
    clip_ids: Sequence[str],
) -> FloatArray:
    """Rows kept and computed, in the order asked; clips that are gone are left out."""
    if not computed:
        return rows[places[places >= 0]]
    made = np.stack(list(computed.values())).astype(np.float32)
    place = {clip_id: row for row, clip_id in enumerate(computed)}
    width = made.shape[1]
    joined = np.zeros((len(clip_ids), width), dtype=np.float32)
    joined[places >= 0] = rows[places[places >= 0]] if len(rows) else 0.0
    late = [i for i in np.flatnonzero(places < 0) if clip_ids[i] in place]
    joined[late] = made[[place[clip_ids[i]] for i in late]]
    is_there = places >= 0
    is_there[late] = True
    return joined[is_there]
