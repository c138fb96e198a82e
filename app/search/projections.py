"""What a fitted model makes of each clip, kept so that only new clips are computed.

A clip that becomes ready after the fit is projected when it is first asked for: this is
the out-of-sample extension of every model, and the reason why searches need no refit.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Sequence

import numpy as np

from app.numerics.arrays import FloatArray

Compute = Callable[[list[str]], dict[str, FloatArray]]
"""Projects clips: ids -> (width,) by id; ids of clips that are gone are left out."""


class Projections:
    """Rows (width,) by clip id, of one version of one model at a time."""

    def __init__(self) -> None:
        self._model = ""
        self._rows: dict[str, FloatArray] = {}
        self._forgotten = 0
        self._lock = threading.Lock()

    def of(
        self, model: str, clip_ids: Sequence[str], compute: Compute
    ) -> tuple[list[str], FloatArray]:
        """The ids that exist and their rows (n, width), by the model with that id."""
        with self._lock:
            if self._model != model:
                self._model, self._rows = model, {}
            forgotten = self._forgotten
            rows = {c: self._rows[c] for c in clip_ids if c in self._rows}
        missing = [clip_id for clip_id in clip_ids if clip_id not in rows]
        if missing:
            computed = compute(missing)
            rows |= computed
            self._keep(model, computed, forgotten)
        there = [clip_id for clip_id in clip_ids if clip_id in rows]
        return there, np.stack([rows[c] for c in there]) if there else np.zeros((0, 0))

    def forget(self, clip_ids: Iterable[str]) -> None:
        """Drop the rows of clips that changed."""
        with self._lock:
            self._forgotten += 1
            for clip_id in clip_ids:
                self._rows.pop(clip_id, None)

    def _keep(self, model: str, computed: dict[str, FloatArray], forgotten: int) -> None:
        with self._lock:
            # Unless something changed meanwhile: then what was computed may be old.
            if (model, forgotten) == (self._model, self._forgotten):
                self._rows |= computed
