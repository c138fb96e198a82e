"""A clip's keyposes, as everything that is built on them takes them.

Where a person has named a clip's keyposes they are its keyposes; else those that were found.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.analysis.analyze import Analysis
from app.analysis.keyposes.keyposes import find_keyposes
from app.analysis.rhythm.beats import Beats
from app.analysis.rhythm.rhythm import BEAT_ARRAYS, beats_of
from app.analysis.segments.keypose_arrays import frames_at, keypose_arrays
from app.errors import NotFound
from app.motion.frame.body_frame import BodyTrack
from app.numerics.arrays import FloatArray, IntArray
from app.services.library.library import Library
from app.store.clips import arrays, keypose_annotations
from app.store.clips.record import ClipRecord
from app.store.database.engine import Tx

KEYPOSE_FRAMES = "keypose_frames"
FEATURES = "features_10hz"
ROLE_POSITIONS = "role_positions"


def keypose_frames(lib: Library, clip_id: str, track: BodyTrack) -> IntArray:
    """(k,) rising frames of `track` at which a ready clip's keyposes are.

    Those that are stored; found anew for a clip that was analysed before they were.
    """
    try:
        with lib.store.read() as tx:
            stored = arrays.get_one(tx, clip_id, KEYPOSE_FRAMES)
    except NotFound:
        stored = find_keyposes(track, beats=stored_beats(lib, clip_id)).frames
    return np.asarray(stored[(stored >= 0) & (stored < track.frames)], dtype=np.int64)


def stored_beats(lib: Library, clip_id: str) -> Beats | None:
    """The beats of a ready clip; None where it was analysed before they were stored."""
    with lib.store.read() as tx:
        return read_beats(tx, clip_id)


def read_beats(tx: Tx, clip_id: str) -> Beats | None:
    """As `stored_beats`, in the caller's transaction."""
    try:
        return beats_of({name: arrays.get_one(tx, clip_id, name) for name in BEAT_ARRAYS})
    except NotFound:
        return None


def annotated_keypose_arrays(tx: Tx, clip: ClipRecord, found: Analysis) -> dict[str, NDArray[Any]]:
    """The arrays to store of a clip whose keyposes a person named; none of any other."""
    named = keypose_annotations.get(tx, clip.id)
    if named is None:
        return {}
    frames = frames_at(np.array(named), len(found.arrays[ROLE_POSITIONS]))
    return keypose_arrays(frames, found.arrays[FEATURES])


def store_keypose_arrays(tx: Tx, clip: ClipRecord, times: FloatArray) -> None:
    """Put keyposes at `times` (seconds) in place of those of a ready clip, in all that is
    built on them."""
    count = len(arrays.get_one(tx, clip.id, ROLE_POSITIONS))
    changed = keypose_arrays(frames_at(times, count), arrays.get_one(tx, clip.id, FEATURES))
    arrays.put_some(tx, clip.id, changed, version=clip.analysis_version or 0)
