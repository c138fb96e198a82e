"""What a fit of words or of a learned metric made of the clips it saw, stored with the model.

So the first search after a fit or a start reads it, instead of computing it for all clips.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.numerics.arrays import FloatArray
from app.services.library.library import Library
from app.store import models
from app.store.clips import versions as library

OUTPUTS = f"{models.OF_CLIPS}outputs"
POINTS = f"{models.OF_CLIPS}points"
_IDS = f"{models.OF_CLIPS}ids"
MAX_VALUES = 50_000_000
"""Outputs beyond so many (200 MB) are not stored: searches compute what they need."""


def precomputed_arrays(
    ids: Sequence[str], outputs: FloatArray | None, points: FloatArray
) -> dict[str, NDArray[Any]]:
    """Arrays to store with the model: word scores (N, V) and coordinates (N, d) of N clips.

    Learned metrics have no word scores.
    """
    if not ids:
        return {}
    kept: dict[str, NDArray[Any]] = {
        _IDS: np.array([list(name) for name in _padded(ids)], dtype=np.uint8),
        POINTS: points.astype(np.float32),
    }
    if outputs is not None and outputs.size <= MAX_VALUES:
        kept[OUTPUTS] = outputs.astype(np.float32)
    return kept


def read_precomputed(lib: Library, model_id: str, name: str) -> tuple[Sequence[str], FloatArray]:
    """Ids (n) and rows (n, width) of OUTPUTS or POINTS, of clips that did not change since."""
    with lib.store.read() as tx:
        stored = models.load_arrays(tx, model_id, (_IDS, name))
        fitted_at = models.get(tx, model_id).library_version
        changes = library.changed_since(tx, fitted_at)
    if name not in stored:
        return (), np.zeros((0, 0))
    ids = [row.tobytes().rstrip(b"\0").decode() for row in stored[_IDS]]
    changed = {*changes.changed, *changes.removed}
    is_same = [row for row, clip_id in enumerate(ids) if clip_id not in changed]
    return [ids[row] for row in is_same], stored[name][is_same]


def _padded(ids: Sequence[str]) -> list[bytes]:
    raw = [clip_id.encode() for clip_id in ids]
    width = max(map(len, raw))
    return [name.ljust(width, b"\0") for name in raw]
