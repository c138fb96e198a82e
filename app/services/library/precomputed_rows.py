"""The outputs of a model for the clips that it was fitted on, stored with the model.

The word models and the learned metrics have such outputs. The first search after a fit or a start
reads them and does not compute them for all clips.
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

OUTPUTS = f"{models.CLIP_ARRAY_PREFIX}outputs"
POINTS = f"{models.CLIP_ARRAY_PREFIX}points"
CCA_POINTS = f"{models.CLIP_ARRAY_PREFIX}cca_points"
IDS = f"{models.CLIP_ARRAY_PREFIX}ids"
MAX_VALUES = 50_000_000
"""Largest number of stored word scores (200 MB as float32). If a library has more, none are
stored, and searches compute what they need."""


def precomputed_arrays(
    ids: Sequence[str],
    outputs: FloatArray | None,
    points: FloatArray,
    cca_points: FloatArray | None = None,
) -> dict[str, NDArray[Any]]:
    """The arrays to store with a model, by name.

    ids: of N clips; outputs: (N, V) their scores for V words, None for a learned metric; points:
    (N, d) their coordinates in the model's space; cca_points: in that of the word mode "cca". All
    are stored as float32.
    """
    if not ids:
        return {}
    stored: dict[str, NDArray[Any]] = {
        IDS: id_rows(ids),
        POINTS: points.astype(np.float32),
    }
    if outputs is not None and outputs.size <= MAX_VALUES:
        stored[OUTPUTS] = outputs.astype(np.float32)
    if cca_points is not None:
        stored[CCA_POINTS] = cca_points.astype(np.float32)
    return stored


def read_precomputed(lib: Library, model_id: str, name: str) -> tuple[Sequence[str], FloatArray]:
    """The stored rows of a model, for the clips that did not change since its fit.

    name: OUTPUTS, POINTS or CCA_POINTS. Returns n ids and their rows (n, width).
    """
    with lib.store.read() as tx:
        stored = models.load_arrays(tx, model_id, (IDS, name))
        fitted_at = models.get(tx, model_id).library_version
        changes = library.changed_since(tx, fitted_at)
    if name not in stored:
        return (), np.zeros((0, 0))
    ids = ids_of(stored[IDS])
    changed = {*changes.changed, *changes.removed}
    unchanged = [row for row, clip_id in enumerate(ids) if clip_id not in changed]
    return [ids[row] for row in unchanged], stored[name][unchanged]


def id_rows(ids: Sequence[str]) -> NDArray[np.uint8]:
    """The ids as (N, longest id) bytes, with zeros at the end: the store holds numeric arrays."""
    raw = [clip_id.encode() for clip_id in ids]
    width = max(map(len, raw), default=0)
    rows = [list(name.ljust(width, b"\0")) for name in raw]
    return np.array(rows, dtype=np.uint8).reshape(len(raw), width)


def ids_of(rows: NDArray[np.uint8]) -> list[str]:
    """The ids of `id_rows`."""
    return [row.tobytes().rstrip(b"\0").decode() for row in rows]
