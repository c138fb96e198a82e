"""A ready clip's keyposes, as everything that is built on them takes them."""

from __future__ import annotations

import numpy as np

from app.analysis.keyposes import find_keyposes
from app.errors import NotFound
from app.motion.body_frame import BodyTrack
from app.numerics.arrays import IntArray
from app.services.library import Library
from app.store import arrays

KEYPOSE_FRAMES = "keypose_frames"


def keypose_frames(lib: Library, clip_id: str, track: BodyTrack) -> IntArray:
    """(k,) rising frames of `track` at which the clip's keyposes are.

    Those that its analysis stored; found anew for a clip that was analysed before it did.
    """
    try:
        with lib.store.read() as tx:
            stored = arrays.get_one(tx, clip_id, KEYPOSE_FRAMES)
    except NotFound:
        stored = find_keyposes(track).frames
    return np.asarray(stored[(stored >= 0) & (stored < track.frames)], dtype=np.int64)
