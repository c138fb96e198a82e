"""Arrays of clips that this version of the analysis can use.

After an upgrade, a clip has its old arrays until it is analyzed again. Arrays of another shape are
left out here. So comparisons work, without that clip.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

from numpy.typing import NDArray

from app.analysis.array_shapes import is_usable
from app.store.clips import arrays
from app.store.database.engine import Tx


def get_some(tx: Tx, clip_id: str, names: Collection[str]) -> dict[str, NDArray[Any]]:
    """The usable arrays among `names` of a clip, by name; missing arrays are left out."""
    stored = arrays.get_some(tx, clip_id, names)
    return {name: array for name, array in stored.items() if is_usable(name, array)}


def get_many(tx: Tx, clip_ids: Collection[str], name: str) -> dict[str, NDArray[Any]]:
    """One array of many clips, by clip id; clips without a usable array are left out."""
    stored = arrays.get_many(tx, clip_ids, name)
    return {clip_id: array for clip_id, array in stored.items() if is_usable(name, array)}
