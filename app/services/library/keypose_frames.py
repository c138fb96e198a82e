"""The keyposes of a clip that segments, models and reductions use.

They are the keyposes that a person annotated. If nobody annotated the clip, they are the keyposes
that the analysis found.
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
from app.services.library.keypose_thresholds import stored_thresholds
from app.services.library.library import Library
from app.store.clips import arrays, keypose_annotations
from app.store.clips.record import ClipRecord
from app.store.database.engine import Tx

KEYPOSE_FRAMES = "keypose_frames"
FEATURES = "features_10hz"
ROLE_POSITIONS = "role_positions"


def keypose_frames(lib: Library, clip_id: str, track: BodyTrack) -> IntArray:
    """(k,) frames of a ready clip's keyposes, in rising order, at the rate of `track` (30 Hz).

    The frames are stored. If the clip's analysis is older than their storage, they are found here.
    """
    try:
        with lib.store.read() as tx:
            frames = arrays.get_one(tx, clip_id, KEYPOSE_FRAMES)
    except NotFound:
        used = stored_thresholds(lib, clip_id)
        beats = stored_beats(lib, clip_id)
        frames = find_keyposes(track, t1=used.t1, t2=used.t2, beats=beats).frames
    # A new analysis may have made the motion shorter than the stored frames.
    return np.asarray(frames[(frames >= 0) & (frames < track.frames)], dtype=np.int64)


def stored_beats(lib: Library, clip_id: str) -> Beats | None:
    """The beats of a ready clip; None if its analysis is older than the storage of beats."""
    with lib.store.read() as tx:
        return read_beats(tx, clip_id)


def read_beats(tx: Tx, clip_id: str) -> Beats | None:
    """The same as `stored_beats`, in the caller's transaction."""
    try:
        return beats_of({name: arrays.get_one(tx, clip_id, name) for name in BEAT_ARRAYS})
    except NotFound:
        return None


def annotated_keypose_arrays(
    tx: Tx, clip: ClipRecord, analysis: Analysis
) -> dict[str, NDArray[Any]]:
    """The arrays by name that replace those of an analysis, since they depend on the keyposes.

    Empty if nobody annotated the clip's keyposes.
    """
    times = keypose_annotations.get(tx, clip.id)
    if times is None:
        return {}
    frames = frames_at(np.array(times), len(analysis.arrays[ROLE_POSITIONS]))
    return keypose_arrays(frames, analysis.arrays[FEATURES])


def store_keypose_arrays(tx: Tx, clip: ClipRecord, times: FloatArray) -> None:
    """Replace the keyposes of a ready clip, and all stored arrays that depend on them.

    times: (k,) seconds of the new keyposes. Raises NotFound for a clip that was removed.
    """
    frame_count = len(arrays.get_one(tx, clip.id, ROLE_POSITIONS))
    changed = keypose_arrays(frames_at(times, frame_count), arrays.get_one(tx, clip.id, FEATURES))
    arrays.put_some(tx, clip.id, changed, version=clip.analysis_version or 0)
