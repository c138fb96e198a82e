"""Ready clips in a store, with arrays that a test chooses."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from app.store.clips import arrays
from app.store.clips import repository as clips
from app.store.clips.record import ClipFacts, ClipLabels, ClipRecord, NewClip
from app.store.store import Store

AddClip = Callable[..., ClipRecord]


def put_ready(
    store: Store, name: str, own: Mapping[str, np.ndarray], duration: float = 2.0, **labels: Any
) -> ClipRecord:
    """Store a ready clip with the arrays `own`; a clip with this name gets the new arrays."""
    new = NewClip(name.encode().hex().zfill(64), f"{name}.bvh", 3, ClipLabels(name, **labels))
    facts = ClipFacts("bvh", 60, 30.0, 30.0, duration, 22, 0.01, {}, (), (), 1)
    with store.write() as tx:
        clip = clips.add_or_get(tx, new).clip
        arrays.put_many(tx, clip.id, own, version=1)
        clips.set_ready(tx, clip.id, facts)
        return clips.get(tx, clip.id)
