"""Stores the keyposes that a manifest gives for a clip. The clip may already have others."""

from __future__ import annotations

import numpy as np

from app.services.clips.merging import OnConflict
from app.services.library.keypose_frames import store_keypose_arrays
from app.store.clips import keypose_annotations
from app.store.clips import repository as clips
from app.store.clips.record import ClipRecord, ClipState, Difference
from app.store.database.engine import Tx

FIELD = "keyposes"


def put_keyposes(
    tx: Tx, clip: ClipRecord, times: tuple[float, ...], policy: OnConflict
) -> tuple[Difference, ...]:
    """Store the times (seconds) that came with a clip, by the rules of `merging`.

    Returns the difference from the stored times. It is empty if they are equal, or if the policy
    is MERGE and the manifest gives the same times as before.
    """
    sent, stored = list(times), list(keypose_annotations.get(tx, clip.id) or ()) or None
    base = clip.imported.get(FIELD)
    is_same = sent == stored
    if not is_same and policy is OnConflict.MERGE and sent == base:
        return ()
    is_applied = policy is OnConflict.UPDATE or (policy is OnConflict.MERGE and stored == base)
    if is_applied and not is_same:
        keypose_annotations.put(tx, clip.id, sent)
        if clip.state is ClipState.READY:
            store_keypose_arrays(tx, clip, np.array(sent))
    if is_applied or is_same:
        clips.patch(tx, clip.id, {"imported": {**clip.imported, FIELD: sent}})
    return () if is_same else (Difference(FIELD, stored, sent, is_applied),)
